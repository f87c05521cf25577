// Sends the person's hands to the server: the desired pose of each handle, and whether the hand
// grips. The page never sends a force, because the program computes the hand's spring and its
// limits.
import {Quaternion, Vector3} from 'three';
import {Connection} from './connection';
import {kSides, Pose, Side} from './protocol';
import {quaternion, vector} from './scene/frames';

const kPeriodMs = 1000 / 55;  // at most 60 messages per second and hand, even with an inexact timer

export class Hands {
  readonly targets: Record<Side, Pose | null> = {left: null, right: null};
  private readonly sentMs: Record<Side, number> = {left: -Infinity, right: -Infinity};

  constructor(private readonly connection: Connection) {
    window.setInterval(() => this.tick(), 8);
  }

  // Grips, or keeps gripping, with the desired handle pose `target` (X_WH).
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

  // Returns the targets of the held handles among `sides` after a rotation about the vertical through
  // their midpoint. `angle` is in radians.
  turned(sides: readonly Side[], angle: number): Map<Side, Pose> {
    const held = sides.flatMap((side) => {
      const target = this.targets[side];
      return target ? [{side, p: vector(target.p), q: quaternion(target.q)}] : [];
    });
    const turn = new Quaternion().setFromAxisAngle(new Vector3(0, 0, 1), angle);
    const middle = held.reduce((sum, {p}) => sum.add(p), new Vector3()).divideScalar(Math.max(held.length, 1));
    return new Map(held.map(({side, p, q}) => {
      const {x, y, z, w} = turn.clone().multiply(q);
      return [side, {p: p.sub(middle).applyQuaternion(turn).add(middle).toArray(), q: [w, x, y, z]}];
    }));
  }

  // Repeats the pose of a held hand, because the server releases a hand after 250 ms without a message.
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
