// Monitors whether the run still sends states and whether it obeyed a stop request. A page that
// shows an old state must not suggest that its stop button works.
import {kSides, RunState, State} from './protocol';

const kSilenceMs = 500;  // states arrive 60 times per second
const kStopMs = 500;     // maximum time from the request to STOPPING
const kLongestStepMs = 150;  // maximum that counts, because a frozen page cannot receive states

export function isStopped(state: RunState): boolean {
  return state === 'STOPPING' || state === 'HELD' || state === 'UNPOWERED';
}

export class RunWatch {
  private lastMs = NaN;
  private silentMs = 0;
  private askedMs = NaN;  // since a stop was requested; NaN: no stop is pending
  private tick = NaN;
  private state: RunState = 'INIT';

  // After a new connection, the first state must arrive within the same time.
  reset() {
    this.silentMs = 0;
    this.askedMs = NaN;
    this.tick = NaN;
  }

  // A state has arrived. A repeated tick is not regarded as a new state.
  heard(tick: number, state: RunState) {
    if (tick === this.tick) return;
    this.tick = tick;
    this.state = state;
    this.silentMs = 0;
    if (isStopped(state)) this.askedMs = NaN;
  }

  // This function is called when the page has sent a stop request.
  asked() {
    if (!isStopped(this.state) && Number.isNaN(this.askedMs)) this.askedMs = 0;
  }

  // Call this function often, with the time of the page's clock [ms].
  pass(nowMs: number) {
    const stepMs = Math.min(Math.max(nowMs - this.lastMs, 0), kLongestStepMs);
    this.lastMs = nowMs;
    if (Number.isNaN(stepMs)) return;
    this.silentMs += stepMs;
    this.askedMs += stepMs;
  }

  // Returns whether no new state has arrived for too long.
  get silent(): boolean {
    return this.silentMs > kSilenceMs;
  }

  // Returns whether a stop request had no effect.
  get ignored(): boolean {
    return this.askedMs > kStopMs;
  }
}

// Detects the events of which a person in a headset must be alerted. They are a stop, a power-off
// at the end of a stop, the fault of an arm, an arm that keeps its power, and the loss of the run.
export class AlarmBell {
  private known: string[] = [];

  // Call this often. `state` is the newest state, or null before the first state. Returns whether
  // one of these events has occurred since the last call.
  rings(state: State | null, trouble: boolean): boolean {
    const now = state ? [] : this.known.filter((it) => it !== 'trouble');
    if (trouble) now.push('trouble');
    if (state) {
      const {stop, harder, hands} = state;
      if (stop.cause !== 'none') now.push('stop');
      if (harder.cause !== 'none') now.push('power');
      const present = kSides.filter((side) => hands[side].present);
      now.push(...present.filter((side) => hands[side].armFault));
      now.push(...present.filter((side) => hands[side].keepsPower).map((side) => `${side} power`));
    }
    const news = now.some((it) => !this.known.includes(it));
    this.known = now;
    return news;
  }
}
