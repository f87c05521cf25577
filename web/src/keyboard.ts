// The keyboard acts as a hand while the scene has the focus. L and R take or release one handle,
// and B takes or releases both handles. Arrow keys move the held handles relative to the camera.
// Page Up and Page Down lift and lower the held handles, and comma and dot rotate them.
import {Vector3} from 'three';
import {Hands} from './hands';
import {kSides, Pose, Side, State} from './protocol';
import {vector} from './scene/frames';
import {Stage} from './scene/stage';

const kStep = 0.005;          // per key press [m]
const kFineStep = 0.001;      // step with Shift [m]
const kTurn = Math.PI / 90;   // per key press, about the vertical [rad]
const kTakes: Record<string, readonly Side[]> = {l: ['left'], r: ['right'], b: kSides};

export class KeyboardHand {
  private held: Side[] = [];
  private state: State | null = null;

  constructor(private readonly stage: Stage, private readonly hands: Hands,
              private readonly mayGrip: () => boolean) {
    const canvas = stage.renderer.domElement;
    canvas.addEventListener('keydown', (event) => this.key(event));
    canvas.addEventListener('blur', () => this.letGo());
    document.addEventListener('visibilitychange', () => {
      if (document.hidden) this.letGo();
    });
  }

  update(state: State) {
    this.state = state;
    if (!this.mayGrip()) this.letGo();
    this.held = this.held.filter((side) => this.hands.targets[side] !== null);
  }

  private key(event: KeyboardEvent) {
    if (event.ctrlKey || event.altKey || event.metaKey || !this.mayGrip()) return;
    const takes = kTakes[event.key.toLowerCase()];
    const by = this.wayOf(event);
    const turn = {',': kTurn, '.': -kTurn}[event.key] ?? 0;
    if (takes && !event.repeat) {
      this.toggle(takes);
    } else if (by) {
      this.move(by);
    } else if (turn !== 0) {
      this.turn(turn);
    } else {
      return;
    }
    event.preventDefault();
  }

  private toggle(sides: readonly Side[]) {
    const present = sides.filter((side) => this.state?.hands[side].present);
    const letGo = present.every((side) => this.held.includes(side));
    for (const side of present) {
      if (letGo) {
        this.hands.release(side);
      } else if (!this.held.includes(side)) {
        this.hands.hold(side, this.state!.hands[side].virtual);
        this.held.push(side);
      }
    }
    if (letGo) this.held = this.held.filter((side) => !present.includes(side));
  }

  private letGo() {
    this.held.forEach((side) => this.hands.release(side));
    this.held = [];
  }

  // Returns the direction of the key in W [m], or null for any other key.
  private wayOf(event: KeyboardEvent): Vector3 | null {
    const step = event.shiftKey ? kFineStep : kStep;
    const {camera} = this.stage.camera;
    const toW = this.stage.world.matrixWorld.clone().invert();
    const right = new Vector3().setFromMatrixColumn(camera.matrixWorld, 0).transformDirection(toW);
    right.setZ(0).normalize();
    const away = new Vector3(0, 0, 1).cross(right);
    switch (event.key) {
      case 'ArrowRight': return right.multiplyScalar(step);
      case 'ArrowLeft': return right.multiplyScalar(-step);
      case 'ArrowUp': return away.multiplyScalar(step);
      case 'ArrowDown': return away.multiplyScalar(-step);
      case 'PageUp': return new Vector3(0, 0, step);
      case 'PageDown': return new Vector3(0, 0, -step);
      default: return null;
    }
  }

  private move(by: Vector3) {
    for (const [side, {p, q}] of this.targets()) {
      this.hands.hold(side, {p: vector(p).add(by).toArray(), q});
    }
  }

  // Rotates both handles about their midpoint.
  private turn(angle: number) {
    this.hands.turned(this.held, angle).forEach((pose, side) => this.hands.hold(side, pose));
  }

  private targets(): [Side, Pose][] {
    return this.held.flatMap((side) => {
      const target = this.hands.targets[side];
      return target ? [[side, target] as [Side, Pose]] : [];
    });
  }
}
