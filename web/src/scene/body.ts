// Shows the body of the person as limbs between the joints, whose colours show their load.
import {
  BufferGeometry, Color, CylinderGeometry, Group, Matrix4, Mesh, MeshLambertMaterial, SphereGeometry, Vector3,
} from 'three';
import {kNotJudged, loadColor} from '../load';
import {BodyPoints} from '../person';
import {kSides, PersonState} from '../protocol';
import {vector} from './frames';

type PointName = keyof BodyPoints;
type PartName = keyof PersonState['parts'];

// The approximate radii [m] at both ends are the same as in reports (a design choice).
interface Limb {
  from: PointName;
  to: PointName;
  radii: [number, number];
  part: PartName | null;  // whose load colours it
}
const kLimbs: Limb[] = kSides.flatMap((side): Limb[] => [
  {from: `${side}_hip`, to: `${side}_knee`, radii: [0.08, 0.055], part: null},
  {from: `${side}_knee`, to: `${side}_ankle`, radii: [0.052, 0.036], part: null},
  {from: `${side}_ankle`, to: `${side}_toes`, radii: [0.036, 0.03], part: null},
  {from: `${side}_shoulder`, to: `${side}_elbow`, radii: [0.048, 0.038], part: `${side}_shoulder`},
  {from: `${side}_elbow`, to: `${side}_wrist`, radii: [0.037, 0.026], part: `${side}_elbow`},
  {from: `${side}_wrist`, to: `${side}_hand`, radii: [0.028, 0.034], part: null},
]);
const kTrunkDepth = 0.11;  // half of it [m]
const kHead = [0.095, 0.08];  // half depth and half width [m]

function solid(geometry: BufferGeometry, material: MeshLambertMaterial): Mesh {
  const mesh = new Mesh(geometry, material);
  mesh.castShadow = true;
  mesh.matrixAutoUpdate = false;
  return mesh;
}

// A cone between two points, with balls at its ends.
class LimbMesh {
  readonly material = new MeshLambertMaterial({color: kNotJudged});
  readonly meshes: Mesh[];
  private readonly shaft: Mesh;
  private readonly balls: Mesh[];

  constructor(readonly limb: Limb, sphere: BufferGeometry) {
    const [a, b] = limb.radii;
    // The cone extends from z = 0 to 1.
    const cone = new CylinderGeometry(b, a, 1, 18, 1, true).rotateX(Math.PI / 2).translate(0, 0, 0.5);
    this.shaft = solid(cone, this.material);
    this.balls = limb.radii.map(() => solid(sphere, this.material));
    this.meshes = [this.shaft, ...this.balls];
  }

  set(points: BodyPoints, scale: number) {
    const ends = [vector(points[this.limb.from]), vector(points[this.limb.to])];
    this.balls.forEach((ball, i) => {
      const radius = 1.03 * scale * this.limb.radii[i];  // a seam would be visible
      ball.matrix.makeScale(radius, radius, radius).setPosition(ends[i]);
    });
    const along = ends[1].clone().sub(ends[0]);
    span(this.shaft.matrix, ends[0], along, new Vector3(0.3, 0.2, 1), [scale, scale, 1]);
  }
}

// Sets the axes. The z axis is along `along` and has its length, and the x axis is near `beside`.
// `size` scales them.
function span(matrix: Matrix4, at: Vector3, along: Vector3, beside: Vector3, size: number[]) {
  const y = along.clone().cross(beside);
  if (y.lengthSq() < 1e-12) y.set(0, 1, 0);
  y.normalize();
  const x = y.clone().cross(along).normalize();
  matrix.makeBasis(x.multiplyScalar(size[0]), y.multiplyScalar(size[1]), along.clone().multiplyScalar(size[2]));
  matrix.setPosition(at);
}

export class Body {
  readonly group = new Group();
  colors: Record<string, number> = {};  // colours of the parts, as drawn
  private readonly limbs: LimbMesh[];
  private readonly trunkMaterial = new MeshLambertMaterial({color: kNotJudged});
  private readonly skinMaterial = new MeshLambertMaterial({color: kNotJudged});
  private readonly chest: Mesh;
  private readonly belly: Mesh;
  private readonly hips: Mesh;
  private readonly head: Mesh;
  private readonly nose: Mesh;
  private readonly neck: Mesh;

  // `scale` is the scale of a small figure, which also applies to its radii.
  constructor(private readonly scale = 1) {
    const sphere = new SphereGeometry(1, 20, 14);
    this.limbs = kLimbs.map((limb) => new LimbMesh(limb, sphere));
    const tube = new CylinderGeometry(1, 0.82, 1, 28).rotateX(Math.PI / 2).translate(0, 0, 0.5);
    this.belly = solid(tube, this.trunkMaterial);
    this.chest = solid(sphere, this.trunkMaterial);
    this.hips = solid(sphere, this.trunkMaterial);
    this.head = solid(sphere, this.skinMaterial);
    this.nose = solid(sphere, this.skinMaterial);
    this.neck = solid(tube, this.skinMaterial);
    this.group.add(...this.limbs.flatMap(({meshes}) => meshes), this.belly, this.chest, this.hips, this.head,
                   this.nose, this.neck);
    this.group.visible = false;
  }

  set(points: BodyPoints) {
    for (const limb of this.limbs) limb.set(points, this.scale);
    const at = (name: PointName) => vector(points[name]);
    const width = at('left_shoulder').distanceTo(at('right_shoulder')) / 2;
    const left = at('left_shoulder').sub(at('right_shoulder'));
    const depth = this.scale * kTrunkDepth;
    const shoulders = at('left_shoulder').add(at('right_shoulder')).divideScalar(2);
    const up = shoulders.clone().sub(at('pelvis'));
    span(this.belly.matrix, at('pelvis'), up.clone().multiplyScalar(0.96), left, [0.86 * width, depth, 1]);
    span(this.chest.matrix, shoulders.clone().addScaledVector(up, -0.08), up, left, [0.92 * width, depth, 0.14]);
    span(this.hips.matrix, at('pelvis'), up, left, [0.8 * width, 1.05 * depth, 0.2]);
    this.placeHead(at('neck'), at('head'), at('eyes'), left);
  }

  // `parts` are the parts in the state of the person, or null if the person is not judged.
  paint(parts: PersonState['parts'] | null) {
    const color = (part: PartName) => loadColor(parts?.[part].load ?? null);
    this.trunkMaterial.color.copy(new Color(color('lower_back')));
    this.colors = {lower_back: color('lower_back')};
    for (const {limb, material} of this.limbs) {
      if (!limb.part) continue;
      this.colors[limb.part] = color(limb.part);
      material.color.copy(new Color(color(limb.part)));
    }
  }

  // The person's own view contains only limbs. The head and the trunk are left out, because the
  // eyes are within the head and the trunk would fill the view.
  showTrunk(on: boolean) {
    for (const part of [this.head, this.nose, this.neck, this.chest, this.belly, this.hips]) part.visible = on;
  }

  private placeHead(neck: Vector3, middle: Vector3, eyes: Vector3, left: Vector3) {
    const up = middle.clone().sub(neck);  // half of the head
    const [depth, width] = kHead.map((x) => this.scale * x);
    span(this.head.matrix, middle, up, left, [width, depth, 0.98]);
    const ahead = eyes.clone().sub(middle);
    ahead.addScaledVector(up, -ahead.dot(up) / up.lengthSq()).normalize();
    const tip = middle.clone().addScaledVector(ahead, depth);
    const radius = 0.017 * this.scale;
    this.nose.matrix.makeScale(radius, radius, 1.6 * radius).setPosition(tip);
    const half = 0.05 * this.scale;
    span(this.neck.matrix, neck.clone().addScaledVector(up, -0.25), up.multiplyScalar(0.8), left, [half, half, 1]);
  }
}
