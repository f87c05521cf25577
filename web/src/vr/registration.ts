// Finds the pose of the virtual world W in the headset's space at which the virtual handles
// coincide with the real handles. This pose consists of a rotation about the vertical and a
// translation, which are fitted to touched points.
//
// Positions in the headset's space have Z up in this file (x right, y forward), like W.
import {Object3D} from 'three';
import {Vec3} from '../protocol';

const kMinSpread = 0.1;  // smallest horizontal distance between the outermost points [m]
const kKey = (scene: string) => `predictor.registration.${scene}`;

export interface Registration {
  yaw: number;           // yaw of W in the headset's space [rad]
  t: Vec3;               // origin of W in the headset's space [m]
  residual: number;      // root mean square of the fit's residuals [m]
}

export interface PointPair {
  touched: Vec3;  // point in the headset's space
  known: Vec3;    // the same point in W
}

// Computes the least-squares solution for all pairs, which minimises Σ |R(yaw) known + t −
// touched|². Throws an Error with a message for the person if the points do not determine the
// rotation.
export function fit(pairs: PointPair[]): Registration {
  const n = pairs.length;
  if (n < 2) throw new Error('At least two points are needed.');
  const mean = (get: (pair: PointPair) => Vec3): Vec3 => {
    const sum: Vec3 = [0, 0, 0];
    for (const pair of pairs) get(pair).forEach((v, i) => (sum[i] += v / n));
    return sum;
  };
  const a = mean((pair) => pair.touched);
  const b = mean((pair) => pair.known);
  let sine = 0;
  let cosine = 0;
  let spread = 0;
  for (const {touched, known} of pairs) {
    const [ax, ay] = [touched[0] - a[0], touched[1] - a[1]];
    const [bx, by] = [known[0] - b[0], known[1] - b[1]];
    sine += bx * ay - by * ax;
    cosine += bx * ax + by * ay;
    spread = Math.max(spread, Math.hypot(bx, by));
  }
  if (2 * spread < kMinSpread || Math.hypot(sine, cosine) < 1e-6) {
    throw new Error('The points are too close together.');
  }
  const yaw = Math.atan2(sine, cosine);
  const turned = turn(b, yaw);
  const t: Vec3 = [a[0] - turned[0], a[1] - turned[1], a[2] - turned[2]];
  const squares = pairs.map(({touched, known}) => {
    const p = turn(known, yaw);
    return (p[0] + t[0] - touched[0]) ** 2 + (p[1] + t[1] - touched[1]) ** 2 +
        (p[2] + t[2] - touched[2]) ** 2;
  });
  return {yaw, t, residual: Math.sqrt(squares.reduce((x, y) => x + y) / n)};
}

// Places W for a person who is at the origin of the headset's space and looks ahead. In W, the
// person's eyes are then at `eye`, and the person stands on the ground below and faces along the
// horizontal direction `forward`. `ground` is the height of the ground in W [m]. This pose applies
// until the person registers the world.
export function standAt(eye: Vec3, forward: Vec3, ground: number): Registration {
  const yaw = Math.PI / 2 - Math.atan2(forward[1], forward[0]);
  const p = turn([eye[0], eye[1], 0], yaw);
  return {yaw, t: [-p[0], -p[1], -ground], residual: NaN};
}

// Converts from the headset's space (Z up) to W.
export function toWorld(p: Vec3, {yaw, t}: Registration): Vec3 {
  return turn([p[0] - t[0], p[1] - t[1], p[2] - t[2]], -yaw);
}

function turn(p: Vec3, yaw: number): Vec3 {
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  return [c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]];
}

// Converts coordinates from the headset's space (axes of three.js, Y up) to axes with Z up, and back.
export function zUp(x: number, y: number, z: number): Vec3 {
  return [x, -z, y];
}

export function applyTo(root: Object3D, registration: Registration) {
  const {yaw, t} = registration;
  root.position.set(t[0], t[2], -t[1]);
  root.rotation.set(0, yaw, 0);
}

export function clearFrom(root: Object3D) {
  root.position.set(0, 0, 0);
  root.rotation.set(0, 0, 0);
}

// Returns the registration that is stored for a scene, or null if none is stored or the stored one
// cannot be read.
export function load(scene: string): Registration | null {
  try {
    const value = JSON.parse(localStorage.getItem(kKey(scene)) ?? 'null') as Registration | null;
    const numbers = value ? [value.yaw, ...value.t, value.residual] : [];
    return value && numbers.length === 5 && numbers.every(Number.isFinite) ? value : null;
  } catch {
    return null;
  }
}

export function store(scene: string, registration: Registration) {
  localStorage.setItem(kKey(scene), JSON.stringify(registration));
}
