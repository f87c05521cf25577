// Converts between the protocol's poses (W: Z up, scalar first) and three.js's matrices.
import {Matrix4, Object3D, Quaternion, Vector3} from 'three';
import {Pose, Quat, Vec3} from '../protocol';

const kOne = new Vector3(1, 1, 1);

export function vector(p: Vec3): Vector3 {
  return new Vector3(p[0], p[1], p[2]);
}

export function quaternion(q: Quat): Quaternion {
  return new Quaternion(q[1], q[2], q[3], q[0]);
}

export function matrix(pose: Pose): Matrix4 {
  return new Matrix4().compose(vector(pose.p), quaternion(pose.q), kOne);
}

// Returns the pose of a rigid transform.
export function poseOf(m: Matrix4): Pose {
  const p = new Vector3();
  const q = new Quaternion();
  m.decompose(p, q, new Vector3());
  return {p: p.toArray(), q: [q.w, q.x, q.y, q.z]};
}

export function place(object: Object3D, pose: Pose) {
  object.position.set(...pose.p);
  object.quaternion.set(pose.q[1], pose.q[2], pose.q[3], pose.q[0]);
}

export function distance(a: Vec3, b: Vec3): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

// Returns the angle of the rotation between two orientations [rad].
export function angle(a: Quat, b: Quat): number {
  const sign = a.reduce((sum, value, i) => sum + value * b[i], 0) < 0 ? -1 : 1;
  // The angle is computed from the chord, because the cosine of a small angle in single precision
  // has an error of 0.03°.
  const chord = Math.hypot(...a.map((value, i) => sign * value - b[i]));
  return 4 * Math.asin(Math.min(chord / 2, 1));
}

// Returns the pose of `object` in the frame of `frame`, from their poses in the scene graph.
export function poseIn(object: Object3D, frame: Object3D): Pose {
  object.updateWorldMatrix(true, false);
  frame.updateWorldMatrix(true, false);
  return poseOf(frame.matrixWorld.clone().invert().multiply(object.matrixWorld));
}
