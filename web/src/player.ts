// Plays the states according to their time stamps, with a delay of about one state. The player
// interpolates between the two states around the present time. There is no queue. The buffer
// contains only the latest few states, and the newest state takes precedence.
import {Pose, Quat, Side, stampMs, State, Vec3} from './protocol';

const kKept = 8;
const kLagSamples = 40;
const kLargestGapMs = 400;  // states with a larger gap are not interpolated

interface Entry {
  state: State;
  stampMs: number;
  receivedMs: number;
  shown: boolean;
}

// A state that was shown for the first time, for the latency statistics.
export interface Shown {
  state: State;
  receivedMs: number;
}

export class StatePlayer {
  private entries: Entry[] = [];
  private lags: number[] = [];

  reset() {
    this.entries = [];
    this.lags = [];
  }

  get latest(): State | null {
    return this.entries.at(-1)?.state ?? null;
  }

  add(state: State, receivedMs: number) {
    const stamp = stampMs(state);
    const last = this.entries.at(-1);
    if (last && stamp <= last.stampMs) {
      if (state.tick >= last.state.tick) return;
      this.reset();  // the run was restarted
    } else if (last && (stamp - last.stampMs > kLargestGapMs || state.runTime < last.state.runTime)) {
      this.entries = [];
    }
    this.entries.push({state, stampMs: stamp, receivedMs, shown: false});
    if (this.entries.length > kKept) this.entries.shift();
    this.lags.push(receivedMs - stamp);
    if (this.lags.length > kLagSamples) this.lags.shift();
  }

  // Returns the interpolated state at the page's time `nowMs`, or null before the first state.
  // Calls `shown` for each state whose time has come.
  sample(nowMs: number, shown: (s: Shown) => void): State | null {
    if (this.entries.length === 0) return null;
    const playMs = nowMs - median(this.lags) - this.intervalMs();
    let after = this.entries.findIndex((e) => e.stampMs > playMs);
    if (after < 0) after = this.entries.length;
    for (let i = 0; i < Math.max(after, 1); i++) {
      const entry = this.entries[i];
      if (!entry.shown) shown(entry);
      entry.shown = true;
    }
    if (after === 0) return this.entries[0].state;
    const a = this.entries[after - 1];
    if (after === this.entries.length) return a.state;
    const b = this.entries[after];
    return interpolate(a.state, b.state, (playMs - a.stampMs) / (b.stampMs - a.stampMs));
  }

  private intervalMs(): number {
    const n = this.entries.length;
    if (n < 2) return 0;
    return (this.entries[n - 1].stampMs - this.entries[0].stampMs) / (n - 1);
  }
}

function median(values: number[]): number {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[sorted.length >> 1];
}

// Interpolates between states `a` and `b`. Only the numbers that describe motion are interpolated.
// All other values are those of `a`.
export function interpolate(a: State, b: State, t: number): State {
  const hand = (side: Side) => ({
    ...a.hands[side],
    real: mixPose(a.hands[side].real, b.hands[side].real, t),
    virtual: mixPose(a.hands[side].virtual, b.hands[side].virtual, t),
    wrench: mix(a.hands[side].wrench, b.hands[side].wrench, t),
    coupling: mix(a.hands[side].coupling, b.hands[side].coupling, t),
    armQ: mix(a.hands[side].armQ, b.hands[side].armQ, t),
  });
  return {
    ...a,
    cobotQ: mix(a.cobotQ, b.cobotQ, t),
    object: mixPose(a.object, b.object, t),
    endEffector: mixPose(a.endEffector, b.endEffector, t),
    movables: a.movables.map((pose, i) => mixPose(pose, b.movables[i], t)),
    hands: {left: hand('left'), right: hand('right')},
    parameters: mix(a.parameters, b.parameters, t),
  };
}

function mix(a: number[], b: number[], t: number): number[] {
  return a.map((value, i) => value + (b[i] - value) * t);
}

// Interpolates linearly along the shorter arc and normalises the result. Linear interpolation is
// accurate enough because states are milliseconds apart.
function mixPose(a: Pose, b: Pose, t: number): Pose {
  const dot = a.q.reduce((sum, value, i) => sum + value * b.q[i], 0);
  const q = mix(a.q, dot < 0 ? b.q.map((x) => -x) : b.q, t);
  const norm = Math.hypot(...q) || 1;
  return {p: mix(a.p, b.p, t) as Vec3, q: q.map((x) => x / norm) as Quat};
}
