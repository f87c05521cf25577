// Measures how closely a person followed a path. The page shows the score when the person has
// finished.
import {kSides, SceneSpec, State} from './protocol';

export interface Score {
  mean: number;     // mean over time [m]
  largest: number;  // [m]
}

const kMinSeconds = 2;   // shorter attempts are not scored
const kLongestStep = 0.2;  // maximum of the counted time between states [s]

export class PathScore {
  private seconds = 0;
  private sum = 0;      // integral of the error over time [m·s]
  private largest = 0;
  private lastTime = NaN;
  private done: Score | null = null;

  clear() {
    this.seconds = 0;
    this.sum = 0;
    this.largest = 0;
    this.lastTime = NaN;
    this.done = null;
  }

  // Call this function for each state with the object's distance from the path [m], which is NaN if
  // there is no path.
  add(state: State, spec: SceneSpec, error: number) {
    if (!Number.isFinite(error)) return;
    if (!follows(state, spec)) {
      if (this.seconds >= kMinSeconds) this.done = this.now;
      this.seconds = 0;
      this.lastTime = NaN;
      return;
    }
    if (this.seconds === 0) {
      this.sum = 0;
      this.largest = 0;
      this.done = null;
    }
    const dt = Math.min(state.runTime - this.lastTime, kLongestStep);
    this.lastTime = state.runTime;
    if (!(dt > 0)) return;
    this.seconds += dt;
    this.sum += error * dt;
    this.largest = Math.max(this.largest, error);
  }

  // Returns the score of the last attempt after this attempt has ended.
  get result(): Score | null {
    return this.done;
  }

  private get now(): Score {
    return {mean: this.sum / this.seconds, largest: this.largest};
  }
}

// Returns true while the script requests the circle or, if the person determines the timing, while
// the object is held.
function follows(state: State, spec: SceneSpec): boolean {
  if (state.state !== 'RUN') return false;
  const action = spec.script[state.action];
  if (spec.script.length > 0) return action?.action === 'circle';
  return kSides.some((side) => state.hands[side].gripping);
}
