// The mouse, a pen or a finger acts as a hand that takes a handle and drags it.
import {Plane, Raycaster, Vector2, Vector3} from 'three';
import {Hands} from './hands';
import {kSides, Pose, Side, State} from './protocol';
import {vector} from './scene/frames';
import {Stage} from './scene/stage';

const kTurnPerNotch = Math.PI / 90;  // per wheel notch, about the vertical [rad]

interface Grip {
  pointer: number;
  main: Side;
  sides: Side[];
  vertical: boolean;
  from: Vector3;                         // where the pointer grabbed on its plane, in W
  plane: Plane;                          // plane in which the pointer moves, in W
  base: Partial<Record<Side, Pose>>;     // targets when the pointer grabbed
}

export class MouseHand {
  bothHands = false;
  hovered: Side | null = null;  // the handle under the pointer, if this page may take it
  private grip: Grip | null = null;
  private state: State | null = null;
  private readonly rays = new Raycaster();

  constructor(private readonly stage: Stage, private readonly hands: Hands,
              private readonly mayGrip: () => boolean) {
    const canvas = stage.renderer.domElement;
    const capture = {capture: true};  // before the camera's controls
    canvas.addEventListener('pointerdown', (e) => this.down(e), capture);
    canvas.addEventListener('pointermove', (e) => this.move(e), capture);
    canvas.addEventListener('pointerup', (e) => this.up(e), capture);
    canvas.addEventListener('pointercancel', (e) => this.up(e), capture);
    canvas.addEventListener('lostpointercapture', (e) => this.up(e), capture);
    canvas.addEventListener('pointerleave', () => (this.hovered = null));
    canvas.addEventListener('wheel', (e) => this.wheel(e), {capture: true, passive: false});
    window.addEventListener('blur', () => this.letGo());
    document.addEventListener('visibilitychange', () => {
      if (document.hidden) this.letGo();
    });
  }

  update(state: State) {
    this.state = state;
    if (this.grip && !this.mayGrip()) this.letGo();
    for (const side of kSides) {
      this.stage.handles[side].setHeld(this.hands.targets[side] !== null);
      this.stage.handles[side].setHovered(this.hovered === side && this.mayGrip());
    }
  }

  private down(event: PointerEvent) {
    if (event.button !== 0 || this.grip || !this.state || !this.mayGrip()) return;
    const side = this.pick(event);
    if (!side) return;
    event.stopImmediatePropagation();
    event.preventDefault();
    const canvas = this.stage.renderer.domElement;
    canvas.focus();
    canvas.setPointerCapture(event.pointerId);
    this.stage.camera.controls.enabled = false;
    const both = this.bothHands !== (event.ctrlKey || event.metaKey);
    const sides = kSides.filter((s) => s === side || (both && this.state!.hands[s].present));
    for (const s of sides) this.hands.hold(s, this.state.hands[s].virtual);
    this.anchor(event, side, sides);
  }

  private move(event: PointerEvent) {
    const canvas = this.stage.renderer.domElement;
    if (!this.grip) {
      this.hovered = this.mayGrip() ? this.pick(event) : null;
      canvas.style.cursor = this.hovered ? 'grab' : '';
      return;
    }
    if (event.pointerId !== this.grip.pointer) return;
    event.stopImmediatePropagation();
    canvas.style.cursor = 'grabbing';
    if (event.shiftKey !== this.grip.vertical) {
      this.anchor(event, this.grip.main, this.grip.sides);
      return;
    }
    const at = this.onPlane(event, this.grip.plane);
    if (!at) return;
    const by = at.sub(this.grip.from);
    if (this.grip.vertical) by.set(0, 0, by.z);
    for (const side of this.grip.sides) {
      const {p, q} = this.grip.base[side]!;
      this.hands.hold(side, {p: vector(p).add(by).toArray(), q});
    }
  }

  private up(event: PointerEvent) {
    if (this.grip?.pointer === event.pointerId) this.letGo();
  }

  // The wheel rotates a held handle about the vertical. If both handles are held, the wheel rotates
  // them about their midpoint.
  private wheel(event: WheelEvent) {
    if (!this.grip) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    const {sides, base} = this.grip;
    for (const [side, turned] of this.hands.turned(sides, -Math.sign(event.deltaY) * kTurnPerNotch)) {
      const moved = vector(turned.p).sub(vector(this.hands.targets[side]!.p));
      base[side] = {p: vector(base[side]!.p).add(moved).toArray(), q: turned.q};
      this.hands.hold(side, turned);
    }
  }

  private letGo() {
    if (!this.grip) return;
    const {sides, pointer} = this.grip;
    this.grip = null;
    sides.forEach((side) => this.hands.release(side));
    const canvas = this.stage.renderer.domElement;
    if (canvas.hasPointerCapture(pointer)) canvas.releasePointerCapture(pointer);
    canvas.style.cursor = '';
    this.stage.camera.controls.enabled = true;
  }

  // Starts to measure the pointer's motion from the present position, in the plane of the screen
  // or, with Shift, vertically.
  private anchor(event: PointerEvent, main: Side, sides: Side[]) {
    const at = vector(this.hands.targets[main]!.p);
    const normal = this.stage.camera.camera.getWorldDirection(new Vector3());
    const vertical = event.shiftKey;
    const {world} = this.stage;
    normal.transformDirection(world.matrixWorld.clone().invert());
    if (vertical) normal.setZ(0);
    if (normal.lengthSq() < 1e-6) normal.set(1, 0, 0);
    const plane = new Plane().setFromNormalAndCoplanarPoint(normal.normalize(), at);
    const from = this.onPlane(event, plane) ?? at;
    const base = Object.fromEntries(sides.map((s) => [s, this.hands.targets[s]!]));
    this.grip = {pointer: event.pointerId, main, sides, vertical, from, plane, base};
  }

  private aim(event: PointerEvent) {
    const box = this.stage.renderer.domElement.getBoundingClientRect();
    this.rays.setFromCamera(
        new Vector2(
            ((event.clientX - box.left) / box.width) * 2 - 1,
            1 - ((event.clientY - box.top) / box.height) * 2),
        this.stage.camera.camera);
  }

  private pick(event: PointerEvent): Side | null {
    this.aim(event);
    const shown = kSides.filter((side) => this.state?.hands[side].present);
    const hits = this.rays.intersectObjects(
        shown.map((side) => this.stage.handles[side].target), false);
    return shown.find((side) => this.stage.handles[side].target === hits[0]?.object) ?? null;
  }

  private onPlane(event: PointerEvent, plane: Plane): Vector3 | null {
    this.aim(event);
    const ray = this.rays.ray.clone().applyMatrix4(this.stage.world.matrixWorld.clone().invert());
    return ray.intersectPlane(plane, new Vector3());
  }
}
