// Finds the view of a camera that contains the cobot, the person and the fixtures.
import {Vector3} from 'three';
import {FixtureSpec, SceneSpec, Vec3} from '../protocol';
import {quaternion, vector} from './frames';

const kCobotHeight = 1;   // of a cobot's elbow above its base, roughly [m]
const kCobotBehind = 0.2; // of a cobot's arm behind its base, roughly [m]
const kAboveEyes = 0.15;  // top of the head [m]
const kBehindEyes = 0.35; // back of the trunk [m]
const kFoot = 0.3;        // from the point between the feet to a foot's end [m]

// The shares of the picture's width and height that cards and instructions cover.
export interface Covered {
  left: number;
  top: number;
}

export interface Place {
  eye: Vector3;
  target: Vector3;
}

// Half extents along the axes of a fixture [m], or null for a plane, which has no end.
function halfExtents({shape, size: [a, b, c]}: FixtureSpec): Vec3 | null {
  switch (shape) {
    case 'box': return [a / 2, b / 2, c / 2];
    case 'cylinder': return [a, a, b / 2];
    case 'capsule': return [a, a, b / 2 + a];
    case 'sphere': return [a, a, a];
    case 'plane': return null;
  }
}

const kSigns = [-1, 1];
const kCorners = kSigns.flatMap((x) => kSigns.flatMap((y) => kSigns.map((z) => [x, y, z])));

function corners(fixture: FixtureSpec): Vec3[] {
  const half = halfExtents(fixture);
  if (!half) return [];
  const {p, q} = fixture.pose;
  return kCorners.map(([x, y, z]) =>
    new Vector3(x * half[0], y * half[1], z * half[2]).applyQuaternion(quaternion(q)).add(vector(p)).toArray());
}

// Returns points in W that enclose what the person and the cobot do [m].
export function pointsToShow(spec: SceneSpec, object: Vec3): Vec3[] {
  const {eye, forward, ground} = spec.viewpoint;
  const [x, y, z] = spec.cobot.base.p;
  const points: Vec3[] = [
    object, [x - kCobotBehind, y, z], [x - kCobotBehind, y, z + kCobotHeight], [eye[0], eye[1], eye[2] + kAboveEyes],
    [eye[0] - kBehindEyes * forward[0], eye[1] - kBehindEyes * forward[1], eye[2]],
    ...(spec.fixtures ?? []).flatMap(corners),
  ];
  if (ground) {
    for (const s of kSigns) {
      points.push([ground[0] + s * kFoot, ground[1], ground[2]], [ground[0], ground[1] + s * kFoot, ground[2]]);
    }
  }
  return points;
}

// Returns the nearest place from which a camera that looks against `toEye` (a unit vector) sees all
// points in the part of the picture that is not covered. The target is as far along `toEye` as
// `about`. `tangent` is that of half the vertical field of view. All vectors are in three.js's
// axes, with Y up [m].
export function frame(points: Vector3[], about: Vector3, toEye: Vector3, tangent: number, aspect: number,
                      covered: Covered): Place & {distance: number} {
  const right = new Vector3(0, 1, 0).cross(toEye).normalize();
  const up = toEye.clone().cross(right);
  // A point is inside the plane with the tangent t at one side if
  // across − shift ≤ t · (distance − depth).
  const fit = (axis: Vector3, low: number, high: number) => {
    const of = (sign: number, t: number) => Math.max(...points.map((p) => {
      const d = p.clone().sub(about);
      return sign * d.dot(axis) + t * d.dot(toEye);
    }));
    return {low, high, most: of(1, high), least: of(-1, low)};
  };
  const x = fit(right, tangent * aspect * (1 - 2 * covered.left), tangent * aspect);
  const y = fit(up, tangent, tangent * (1 - 2 * covered.top));
  const distance = Math.max(...[x, y].map(({low, high, most, least}) => (most + least) / (low + high)));
  // Halfway between the smallest and the largest possible shift.
  const [across, upwards] = [x, y].map(({low, high, most, least}) =>
    (most - high * distance + low * distance - least) / 2);
  const target = about.clone().addScaledVector(right, across).addScaledVector(up, upwards);
  return {eye: target.clone().addScaledVector(toEye, distance), target, distance};
}
