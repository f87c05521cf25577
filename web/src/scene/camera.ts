// Controls the camera of the page, which has preset views and can orbit freely. In this file, the
// axes of the world are those of three.js, with Y up.
import {Object3D, PerspectiveCamera, Vector3} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import {Pose, SceneSpec, Vec3} from '../protocol';
import {matrix} from './frames';
import {frame, Place, pointsToShow} from './framing';

export type View = 'free' | 'front' | 'side' | 'top' | 'operator' | 'headset';
// In the order of the buttons and of the keys 1, 2, …
export const kViews: readonly View[] = ['free', 'front', 'side', 'top', 'operator', 'headset'];

const kMoveMs = 450;
const kFieldOfView = 42;          // vertical [°]
const kHeadsetFieldOfView = 75;   // [°]
const kInstructionHeight = 60;    // of the scene's top edge [px]
const kNearest = 1.6, kFarthest = 3.8;  // distance of a view that contains the body [m]

export class CameraRig {
  readonly camera = new PerspectiveCamera(kFieldOfView, 1, 0.02, 40);
  readonly controls: OrbitControls;
  view: View = 'free';
  covered: () => number = () => 0;  // share of the picture's width that a card at its left covers
  private move: {from: Place; to: Place; startMs: number} | null = null;
  private headset: Pose | null = null;

  constructor(private readonly element: HTMLElement, private readonly world: Object3D) {
    this.controls = new OrbitControls(this.camera, element);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.minDistance = 0.25;
    this.controls.maxDistance = 5;
    this.controls.maxPolarAngle = Math.PI * 0.56;
    this.controls.addEventListener('start', () => {
      this.move = null;
      if (this.view !== 'free') this.leaveHeadset();
      this.view = 'free';
    });
  }

  // Moves the camera to its first view without an animation, when the page opens.
  jump(view: View, spec: SceneSpec, object: Vec3) {
    this.view = view;
    this.stand(this.placeOf(view, spec, object));
  }

  go(view: View, spec: SceneSpec, object: Vec3) {
    this.leaveHeadset();
    this.view = view;
    if (view === 'headset') return;
    const to = this.placeOf(view, spec, object);
    if (matchMedia('(prefers-reduced-motion: reduce)').matches) return this.stand(to);
    this.stopInertia();
    const from = {eye: this.camera.position.clone(), target: this.controls.target.clone()};
    this.move = {from, to, startMs: performance.now()};
  }

  // Sets the pose of a person's headset in W, or null if there is no headset.
  setHeadset(pose: Pose | null) {
    this.headset = pose;
  }

  update(nowMs: number) {
    if (this.view === 'headset' && this.headset) return this.follow(this.headset);
    if (this.move) {
      const t = Math.min((nowMs - this.move.startMs) / kMoveMs, 1);
      const s = t * t * (3 - 2 * t);
      this.stand({
        eye: this.move.from.eye.clone().lerp(this.move.to.eye, s),
        target: this.move.from.target.clone().lerp(this.move.to.target, s),
      });
      if (t === 1) this.move = null;
      return;
    }
    if (this.controls.enabled) this.controls.update();
  }

  resize(width: number, height: number) {
    this.camera.aspect = width / Math.max(height, 1);
    this.camera.updateProjectionMatrix();
  }

  // Without this call, the inertia of the last manual turn would continue after the move.
  private stopInertia() {
    this.controls.enableDamping = false;
    this.controls.update();
    this.controls.enableDamping = true;
  }

  private follow(pose: Pose) {
    const place = this.world.matrixWorld.clone().multiply(matrix(pose));
    place.decompose(this.camera.position, this.camera.quaternion, new Vector3());
    this.setFieldOfView(kHeadsetFieldOfView);
  }

  private leaveHeadset() {
    this.setFieldOfView(kFieldOfView);
  }

  private setFieldOfView(degrees: number) {
    if (this.camera.fov === degrees) return;
    this.camera.fov = degrees;
    this.camera.updateProjectionMatrix();
  }

  private stand(place: Place) {
    this.camera.position.copy(place.eye);
    this.controls.target.copy(place.target);
    this.camera.lookAt(place.target);
  }

  private placeOf(view: View, spec: SceneSpec, object: Vec3): Place {
    const base = spec.cobot.base.p;
    const middle: Vec3 = [(base[0] + object[0]) / 2 + 0.08, (base[1] + object[1]) / 2, base[2] + 0.42];
    const at = (eye: Vec3, target: Vec3): Place => ({
      eye: this.toThree(eye),
      target: this.toThree(target),
    });
    const from = (x: number, y: number, z: number) =>
      at([middle[0] + x, middle[1] + y, middle[2] + z], middle);
    // The views contain the body, unless a pointer needs large handles.
    const judged = spec.person?.judged === true && spec.operator !== 'browser';
    const around = (x: number, y: number, z: number) =>
      this.placeAround(pointsToShow(spec, object), middle, [x, y, z]);
    switch (view) {
      case 'front': return judged ? around(1.8, 0, 0.6) : from(1.8, 0, 0.2);
      case 'side': return judged ? around(0.2, -2.6, 0.25) : from(0, -1.8, 0.15);
      case 'top': return from(-0.001, 0, 1.9);
      case 'operator': {
        const {eye, forward} = spec.viewpoint;
        return at(eye, [
          object[0] + 0.1 * forward[0], object[1] + 0.1 * forward[1], object[2] + 0.05,
        ]);
      }
      default: return judged ? around(0.7, -2.6, 0.7) : from(0.97, -1.04, 0.54);
    }
  }

  // Returns a place in the given direction from the middle, from which the camera sees all points
  // beside the card and below the instruction.
  private placeAround(points: Vec3[], middle: Vec3, direction: Vec3): Place {
    const toEye = this.toThree(direction).normalize();
    const tangent = Math.tan((kFieldOfView * Math.PI) / 360);
    const covered = {
      left: Math.min(this.covered(), 0.4),
      top: Math.min(kInstructionHeight / Math.max(this.element.clientHeight, 1), 0.3),
    };
    const {eye, target, distance} = frame(
        points.map((p) => this.toThree(p)), this.toThree(middle), toEye, tangent, this.camera.aspect, covered);
    return {eye: eye.addScaledVector(toEye, Math.min(Math.max(distance, kNearest), kFarthest) - distance), target};
  }

  // While no one uses a headset, the page's world has a fixed pose.
  private toThree(p: Vec3): Vector3 {
    return new Vector3(p[0], p[2], -p[1]);
  }
}
