// Shows the force and the torque of a hand as arrows at its handle. The colour of an arrow shows
// how close the value is to its threshold.
import {
  ConeGeometry, CylinderGeometry, Group, Mesh, MeshStandardMaterial, Quaternion, TorusGeometry,
  Vector3,
} from 'three';
import {kMeaning} from '../theme';
import {level, Level} from '../words';

const kLengthAtThreshold = 0.3;   // length of a force arrow at the threshold [m]
const kShortest = 0.02;           // length below which no arrow is drawn [m]
const kRingRadius = 0.085;        // radius of a torque arrow [m]
const kRingAngle = Math.PI * 1.5; // angle of a torque arrow's arc at the threshold [rad]
const kSlices = 24;               // steps of the arc's growth
const kOverEverything = 20;       // order of drawing
const kZ = new Vector3(0, 0, 1);

const kHoldMs = 500;  // minimum time for which a colour is shown, so that short pushes are visible
const kLevels: readonly Level[] = ['green', 'orange', 'red'];

class Colored {
  // The arrows are drawn over all other parts of the scene, because a hand's force must be visible
  // even if the object hides the handle.
  readonly material = new MeshStandardMaterial(
      {roughness: 0.4, emissiveIntensity: 0.35, depthTest: false, transparent: true});
  level: Level = 'green';
  private held: Level = 'green';
  private heldUntilMs = -Infinity;

  // Reports a value that was reached, possibly between two frames.
  reached(value: number, threshold: number, nowMs: number) {
    const now = level(value, threshold);
    if (nowMs < this.heldUntilMs && kLevels.indexOf(now) < kLevels.indexOf(this.held)) return;
    this.held = now;
    this.heldUntilMs = nowMs + kHoldMs;
  }

  paint(value: number, threshold: number) {
    const now = level(value, threshold);
    const held = performance.now() < this.heldUntilMs ? this.held : 'green';
    this.level = kLevels[Math.max(kLevels.indexOf(now), kLevels.indexOf(held))];
    this.material.color.set(kMeaning[this.level]);
    this.material.emissive.set(kMeaning[this.level]);
  }
}

class ForceArrow extends Colored {
  readonly group = new Group();
  private readonly shaft = new Mesh(
      new CylinderGeometry(0.009, 0.009, 1, 20).rotateX(Math.PI / 2).translate(0, 0, 0.5),
      this.material);
  private readonly head = new Mesh(
      new ConeGeometry(0.024, 0.06, 28).rotateX(Math.PI / 2).translate(0, 0, 0.03), this.material);

  constructor() {
    super();
    this.group.add(this.shaft, this.head);
  }

  set(force: Vector3, threshold: number) {
    const size = force.length();
    this.paint(size, threshold);
    const length = (kLengthAtThreshold * size) / threshold;
    this.group.visible = length > kShortest;
    if (!this.group.visible) return;
    this.group.quaternion.setFromUnitVectors(kZ, force.clone().normalize());
    this.shaft.scale.z = Math.max(length - 0.05, 0.001);
    this.head.position.z = this.shaft.scale.z;
  }
}

class TorqueArrow extends Colored {
  readonly group = new Group();
  private readonly arcs = Array.from({length: kSlices}, (_, i) => new TorusGeometry(
      kRingRadius, 0.0055, 10, 4 + 2 * i, (kRingAngle * (i + 1)) / kSlices));
  private readonly ring = new Mesh(this.arcs[0], this.material);
  private readonly head = new Mesh(new ConeGeometry(0.017, 0.042, 24), this.material);

  constructor() {
    super();
    this.group.add(this.ring, this.head);
  }

  set(torque: Vector3, threshold: number) {
    const size = torque.length();
    this.paint(size, threshold);
    this.group.visible = size > 0.06 * threshold;
    if (!this.group.visible) return;
    const part = Math.min(size / threshold, 1);
    const slice = Math.min(Math.floor(part * kSlices), kSlices - 1);
    this.ring.geometry = this.arcs[slice];
    const end = (kRingAngle * (slice + 1)) / kSlices;
    this.head.position.set(kRingRadius * Math.cos(end), kRingRadius * Math.sin(end), 0);
    this.head.rotation.z = end;
    this.group.quaternion.copy(
        new Quaternion().setFromUnitVectors(kZ, torque.clone().normalize()));
  }
}

export class WrenchArrows {
  readonly group = new Group();
  readonly force = new ForceArrow();
  readonly torque = new TorqueArrow();

  constructor() {
    this.group.add(this.force.group, this.torque.group);
    this.group.traverse((node) => (node.renderOrder = kOverEverything));
    this.group.visible = false;
  }

  // Reports the largest force and torque since the previous state [N], [N·m].
  reached(peak: number[], forceThreshold: number, torqueThreshold: number) {
    const nowMs = performance.now();
    if (peak[0] >= 0) this.force.reached(peak[0], forceThreshold, nowMs);
    if (peak[1] >= 0) this.torque.reached(peak[1], torqueThreshold, nowMs);
  }

  // Sets the wrench of the hand on the handle at `origin`, in axes of W [N], [N·m].
  set(origin: Vector3, wrench: number[], forceThreshold: number, torqueThreshold: number) {
    this.group.position.copy(origin);
    this.force.set(new Vector3(wrench[0], wrench[1], wrench[2]), forceThreshold);
    this.torque.set(new Vector3(wrench[3], wrench[4], wrench[5]), torqueThreshold);
  }
}
