// The person's hands as the page tells them: where each wants its handle, and whether it grips. Never
// a force: the hand's spring and its limits are the rig's.
import {Connection} from './connection';
import {kSides, Pose, Side} from './protocol';

const kPeriodMs = 1000 / 55;  // at most 60 a second and hand, also with an inexact timer

export class Hands {
  readonly targets: Record<Side, Pose | null> = {left: null, right: null};
  private readonly sentMs: Record<Side, number> = {left: -Infinity, right: -Infinity};

  constructor(private readonly connection: Connection) {
    window.setInterval(() => this.tick(), 8);
  }

  // Grips, or goes on gripping, with the handle wanted at `target` (X_WH).
  hold(side: Side, target: Pose) {
    this.targets[side] = target;
  }

  release(side: Side) {
    const target = this.targets[side];
    if (!target) return;
    this.targets[side] = null;
    this.send(side, target, false);
  }

  releaseAll() {
    kSides.forEach((side) => this.release(side));
  }

  get holding(): boolean {
    return kSides.some((side) => this.targets[side] !== null);
  }

  // A held hand repeats itself: silence of 250 ms lets go.
  private tick() {
    if (!this.connection.hasOperator) {
      kSides.forEach((side) => (this.targets[side] = null));
      return;
    }
    const nowMs = performance.now();
    for (const side of kSides) {
      const target = this.targets[side];
      if (!target || nowMs - this.sentMs[side] < kPeriodMs) continue;
      this.sentMs[side] = nowMs;
      this.send(side, target, true);
    }
  }

  private send(side: Side, target: Pose, grip: boolean) {
    this.connection.send({type: 'hand', hand: side, grip, p: target.p, q: target.q});
  }
}
