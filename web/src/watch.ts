// Whether the run still talks, and whether it took a stop: a page that shows an old state must not look
// as if its stop button worked.
import {kSides, RunState, State} from './protocol';

const kSilenceMs = 500;  // states come 60 times a second
const kStopMs = 500;     // from asking to STOPPING, at the most
const kLongestStepMs = 150;  // that counts: while the page itself stands still nothing can be heard

export function isStopped(state: RunState): boolean {
  return state === 'STOPPING' || state === 'HELD' || state === 'UNPOWERED';
}

export class RunWatch {
  private lastMs = NaN;
  private silentMs = 0;
  private askedMs = NaN;  // since a stop was asked for; NaN: none is awaited
  private tick = NaN;
  private state: RunState = 'INIT';

  // Of a new connection nothing is known yet: it has the same time to talk.
  reset() {
    this.silentMs = 0;
    this.askedMs = NaN;
    this.tick = NaN;
  }

  // A state came. The same tick again is no news.
  heard(tick: number, state: RunState) {
    if (tick === this.tick) return;
    this.tick = tick;
    this.state = state;
    this.silentMs = 0;
    if (isStopped(state)) this.askedMs = NaN;
  }

  // A stop was sent.
  asked() {
    if (!isStopped(this.state) && Number.isNaN(this.askedMs)) this.askedMs = 0;
  }

  // Often, with the page's clock [ms].
  pass(nowMs: number) {
    const stepMs = Math.min(Math.max(nowMs - this.lastMs, 0), kLongestStepMs);
    this.lastMs = nowMs;
    if (Number.isNaN(stepMs)) return;
    this.silentMs += stepMs;
    this.askedMs += stepMs;
  }

  // No new state for too long.
  get silent(): boolean {
    return this.silentMs > kSilenceMs;
  }

  // A stop was asked for and nothing came of it.
  get ignored(): boolean {
    return this.askedMs > kStopMs;
  }
}

// What a person in a headset is to hear of: a stop, what takes the power off at its end, the fault of an
// arm, power that an arm keeps, and the loss of the run.
export class AlarmBell {
  private known: string[] = [];

  // Often; state: the newest, null before the first. Whether one of them has come since the last time.
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
