// Plays a tone at a stop. The tone consists of two falling beeps, which are loud enough to be
// noticed in a headset.

export class Tone {
  played = 0;
  private context: AudioContext | null = null;

  // Browsers allow sound only after a user action, so this function must be called during such an
  // action.
  unlock() {
    this.context ??= new AudioContext();
    void this.context.resume();
  }

  play() {
    this.played++;
    if (!this.context) return;
    const start = this.context.currentTime;
    for (const [at, hertz] of [[0, 880], [0.28, 520]]) {
      const oscillator = this.context.createOscillator();
      const volume = this.context.createGain();
      oscillator.frequency.value = hertz;
      volume.gain.setValueAtTime(0, start + at);
      volume.gain.linearRampToValueAtTime(0.35, start + at + 0.02);
      volume.gain.linearRampToValueAtTime(0, start + at + 0.24);
      oscillator.connect(volume).connect(this.context.destination);
      oscillator.start(start + at);
      oscillator.stop(start + at + 0.25);
    }
  }
}
