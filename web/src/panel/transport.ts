// Shows the controls for playing a recording: position, speed and single steps. These controls
// replace the stop button.
import {Connection} from '../connection';
import {h, setAttribute, setText} from '../dom';
import {SceneSpec, State} from '../protocol';

const kSpeeds = [0.1, 0.25, 0.5, 1, 2, 4, 8, 16];
const kStillMs = 500;     // playback counts as paused if the position is unchanged for this time
const kHandsOffMs = 1000;  // after this time without input, the slider follows the recording again
const kStepTicks = 1;
const kLeapTicks = 100;

export class Transport {
  readonly element: HTMLElement;
  private readonly playButton = h('button', {
    id: 'play', 'aria-keyshortcuts': 'Space', onclick: () => this.toggle(),
  }, '▶ Play');
  private readonly slider = h('input', {
    id: 'seek', type: 'range', min: 0, max: 1, step: 0.001, value: 0, 'aria-label': 'Position in the recording',
    oninput: () => this.seek(),
  });
  private readonly speed = h(
      'select', {id: 'speed', 'aria-label': 'Speed', onchange: () => this.changeSpeed()},
      ...kSpeeds.map((x) => h('option', {value: x, selected: x === 1}, `${x} ×`)));
  private readonly time = h('output', {for: 'seek', id: 'place'});
  private readonly buttons: HTMLButtonElement[];
  private replay: SceneSpec['replay'];
  private rate = 1000;
  private place = 0;  // [s]
  private playing = true;
  private movedMs = -Infinity;
  private touchedMs = -Infinity;
  private asked = false;  // control was requested since the welcome

  constructor(private readonly connection: Connection) {
    const step = (label: string, words: string, ticks: number) =>
      h('button', {class: 'small', title: words, 'aria-label': words,
                   onclick: () => this.step(ticks)}, label);
    this.buttons = [
      step('−100', `${kLeapTicks} ticks back`, -kLeapTicks), step('−1', 'One tick back', -kStepTicks),
      step('+1', 'One tick forward', kStepTicks), step('+100', `${kLeapTicks} ticks forward`, kLeapTicks),
    ];
    this.element = h(
        'div', {class: 'transport', role: 'group', 'aria-label': 'Recording', hidden: true},
        h('div', {class: 'row'}, this.playButton, this.speed),
        h('div', {}, this.slider), this.time,
        h('div', {class: 'row'}, ...this.buttons));
  }

  build(spec: SceneSpec) {
    this.replay = spec.replay;
    this.rate = spec.rate;
    this.element.hidden = !spec.replay;
    if (!spec.replay) return;
    this.slider.max = String(spec.replay.duration);
    this.asked = false;
  }

  update(state: State | null, nowMs: number) {
    if (!this.replay || !state) return;
    this.takeControl();
    const place = (state.tick - this.replay.first_tick) / this.rate;
    this.follow(place, nowMs);
    if (nowMs - this.touchedMs > kHandsOffMs) this.slider.value = String(place);
    setText(this.time, `${place.toFixed(3)} / ${this.replay.duration.toFixed(1)} s · tick ${state.tick}`);
    setText(this.playButton, this.playing ? '❚❚ Pause' : '▶ Play');
    setAttribute(this.slider, 'aria-valuetext', `${place.toFixed(2)} s`);
    const may = this.connection.hasControl;
    for (const control of [this.playButton, this.slider, this.speed, ...this.buttons]) {
      control.disabled = !may;
    }
  }

  toggle() {
    this.playing = !this.playing;
    this.touchedMs = performance.now();
    this.connection.send({type: 'replay', play: this.playing ? Number(this.speed.value) : 0});
  }

  // The page requests control when it opens, because the person wants to play the recording. The
  // first page that requests control receives control.
  private takeControl() {
    const {phase, role, leases} = this.connection;
    if (this.asked || phase !== 'open') return;
    this.asked = true;
    if (role === 'control' && leases.control === null) {
      this.connection.send({type: 'lease', what: 'control', take: true});
    }
  }

  // Determines from the received positions whether the recording is playing. Another page may have
  // started the playback, or the recording may have ended.
  private follow(place: number, nowMs: number) {
    const moved = place !== this.place;
    this.place = place;
    if (moved) this.movedMs = nowMs;
    if (nowMs - this.touchedMs < kHandsOffMs) return;
    if (moved) {
      this.playing = true;
    } else if (nowMs - this.movedMs > kStillMs) {
      this.playing = false;
    }
  }

  private step(ticks: number) {
    this.playing = false;
    this.touchedMs = performance.now();
    this.connection.send({type: 'replay', step: ticks});
  }

  private seek() {
    this.touchedMs = performance.now();
    this.connection.send({type: 'replay', seek: Number(this.slider.value)});
  }

  private changeSpeed() {
    if (this.playing) {
      this.connection.send({type: 'replay', play: Number(this.speed.value)});
    }
  }
}
