// Shows the floor, the grid, the table, the fixtures and the light.
import {
  Box3, BoxGeometry, BufferGeometry, CapsuleGeometry, CircleGeometry, Color, CylinderGeometry, DirectionalLight, DoubleSide,
  Float32BufferAttribute, Fog, Group, HemisphereLight, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial,
  MeshStandardMaterial, PlaneGeometry, Scene, SphereGeometry, SRGBColorSpace,
} from 'three';
import {FixtureSpec, SceneSpec, Vec3} from '../protocol';
import {kSceneColors, Theme} from '../theme';
import {Label} from './label';

const kFloorRadius = 6;   // [m]
const kKeepOutOpacity = 0.3;
const kAboveVolume = 0.04;  // of the label of a keep-out volume [m]
const kGridHalf = 3;      // [m]
const kGridStep = 0.1;    // [m]
const kMajorEvery = 5;    // lines
// If the ground is below the virtual floor, this floor is shown as a round table on a column.
const kPlate = {radius: 1, thickness: 0.03, column: 0.12};  // [m]
const kBesidePlate = 0.25, kMinPlate = 0.4;  // distance of the plate's edge from the feet; minimum radius [m]
const kFoot = [0.13, 0.05];  // half length and half width of a footprint [m]

function gridLines(minor: boolean): BufferGeometry {
  const points: number[] = [];
  const n = Math.round(kGridHalf / kGridStep);
  for (let i = -n; i <= n; i++) {
    if ((i % kMajorEvery !== 0) !== minor) continue;
    const at = i * kGridStep;
    points.push(at, -kGridHalf, 0, at, kGridHalf, 0, -kGridHalf, at, 0, kGridHalf, at, 0);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(points, 3));
  return geometry;
}

// The axis of a cylinder or capsule and the normal of a plane are along z.
function fixtureForm({shape, size: [a, b, c]}: FixtureSpec): BufferGeometry {
  switch (shape) {
    case 'box': return new BoxGeometry(a, b, c);
    case 'cylinder': return new CylinderGeometry(a, a, b, 48).rotateX(Math.PI / 2);
    case 'capsule': return new CapsuleGeometry(a, b, 12, 32).rotateX(Math.PI / 2);
    case 'sphere': return new SphereGeometry(a, 48, 24);
    case 'plane': return new PlaneGeometry(a, b);
  }
}

function fixtureMesh(fixture: FixtureSpec): Mesh {
  const {pose: {p, q}, color, keep_out: keepOut = false} = fixture;
  const mesh = new Mesh(fixtureForm(fixture), new MeshStandardMaterial({
    color: new Color().setRGB(...color, SRGBColorSpace), roughness: 0.8, side: DoubleSide,
    transparent: keepOut, opacity: keepOut ? kKeepOutOpacity : 1, depthWrite: !keepOut,
  }));
  mesh.position.set(...p);
  mesh.quaternion.set(q[1], q[2], q[3], q[0]);
  mesh.castShadow = mesh.receiveShadow = !keepOut;
  return mesh;
}

function boxOf(mesh: Mesh): Box3 {
  mesh.updateMatrix();
  mesh.geometry.computeBoundingBox();
  return mesh.geometry.boundingBox!.clone().applyMatrix4(mesh.matrix);
}

export class Room {
  readonly group = new Group();
  private readonly floor = new Mesh(
      new CircleGeometry(kFloorRadius, 64), new MeshLambertMaterial());
  private readonly minor = new LineSegments(gridLines(true), new LineBasicMaterial());
  private readonly major = new LineSegments(gridLines(false), new LineBasicMaterial());
  private readonly sky = new HemisphereLight(0xffffff, 0x8a94a3);
  private readonly sun = new DirectionalLight(0xffffff);
  private readonly fill = new DirectionalLight(0xbdd4ff, 0.6);
  private readonly ground = new Group();  // the floor with its grid, on which the operator stands
  private readonly plate = new Group();
  private readonly plateMaterial = new MeshLambertMaterial();
  private readonly top = new Mesh(
      new CylinderGeometry(kPlate.radius, kPlate.radius, kPlate.thickness, 96), this.plateMaterial);
  private readonly column = new Mesh(
      new CylinderGeometry(kPlate.column, kPlate.column, 1, 32), this.plateMaterial);
  private readonly feet = [1, -1].map(() => new Mesh(
      new CircleGeometry(1, 32), new MeshLambertMaterial({color: 0x5b8def})));
  private table: Mesh | null = null;
  private readonly fixtures = new Group();
  private labels: Label[] = [];  // of keep-out volumes, above them

  constructor() {
    this.floor.receiveShadow = true;
    this.minor.position.z = 0.001;
    this.major.position.z = 0.0015;
    this.sun.position.set(1.2, -1.6, 3.2);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(1024, 1024);
    this.sun.shadow.radius = 4;
    this.sun.shadow.bias = -0.0004;
    this.sun.shadow.normalBias = 0.01;
    Object.assign(this.sun.shadow.camera, {left: -1.6, right: 1.6, top: 1.6, bottom: -1.6, far: 8});
    this.sun.target.position.set(0.3, 0, 0.3);
    this.fill.position.set(-2, 2.5, 1.5);
    const {top} = this;
    top.position.z = -kPlate.thickness / 2;
    top.receiveShadow = true;
    top.castShadow = true;
    [top, this.column].forEach((part) => (part.rotation.x = Math.PI / 2));
    this.plate.add(top, this.column);
    this.feet.forEach((foot) => foot.scale.set(kFoot[0], kFoot[1], 1));
    this.ground.add(this.floor, this.minor, this.major, ...this.feet);
    this.group.add(
        this.ground, this.plate, this.sky, this.sun, this.sun.target, this.fill, this.fixtures);
  }

  build(spec: SceneSpec) {
    this.stand(spec);
    this.setFixtures(spec.fixtures ?? []);
    this.table?.removeFromParent();
    this.table = null;
    if (!spec.table) return;
    const {size, top} = spec.table;
    this.table = new Mesh(
        new BoxGeometry(...size), new MeshStandardMaterial({color: 0x9c7b57, roughness: 0.8}));
    this.table.position.set(top[0], top[1], top[2] - size[2] / 2);
    this.table.castShadow = true;
    this.table.receiveShadow = true;
    this.group.add(this.table);
  }

  // Shows only these fixtures.
  setFixtures(fixtures: FixtureSpec[]) {
    this.fixtures.clear();
    this.labels.forEach((label) => label.dispose());
    this.labels = [];
    for (const fixture of fixtures) {
      const mesh = fixtureMesh(fixture);
      this.fixtures.add(mesh);
      if (fixture.keep_out) this.addLabel(fixture.name ?? '', mesh);
    }
  }

  private addLabel(name: string, mesh: Mesh) {
    const label = new Label(name === '' ? 'keep-out volume' : `keep-out volume: ${name}`);
    const {min, max} = boxOf(mesh);
    label.sprite.position.set((min.x + max.x) / 2, (min.y + max.y) / 2, max.z + kAboveVolume);
    this.labels.push(label);
    this.group.add(label.sprite);
  }

  get fixtureLabels(): {text: string; p: Vec3}[] {
    return this.labels.map(({text, sprite}) => ({text, p: sprite.position.toArray()}));
  }

  get fixtureBoxes(): {min: Vec3; max: Vec3; opacity: number}[] {
    return this.fixtures.children.map((child) => {
      const mesh = child as Mesh<BufferGeometry, MeshStandardMaterial>;
      const box = boxOf(mesh);
      return {min: box.min.toArray(), max: box.max.toArray(), opacity: mesh.material.opacity};
    });
  }

  // The ground is the surface on which the operator stands. If the ground is below the virtual
  // floor, the virtual floor is drawn as a plate above the ground.
  private stand({viewpoint, floor, cobot}: SceneSpec) {
    const {ground, forward, feet} = viewpoint;
    this.ground.position.z = ground?.[2] ?? 0;
    const raised = ground !== null && ground[2] < 0;
    this.floor.visible = floor || ground !== null;
    this.plate.visible = floor && raised;
    const middle = [cobot.base.p[0] + 0.25, cobot.base.p[1]];
    this.plate.position.set(middle[0], middle[1], 0);
    // The plate must not pass through the operator's legs.
    const room = ground ? Math.hypot(ground[0] - middle[0], ground[1] - middle[1]) - kBesidePlate : kPlate.radius;
    const radius = Math.min(Math.max(room, kMinPlate), kPlate.radius);
    this.top.scale.set(radius / kPlate.radius, 1, radius / kPlate.radius);
    const depth = raised ? -ground[2] : 1;
    this.column.scale.y = depth;
    this.column.position.z = -depth / 2;
    this.feet.forEach((foot, i) => {
      foot.visible = ground !== null;
      if (!ground) return;
      const side = (i === 0 ? 0.5 : -0.5) * feet;
      foot.position.set(ground[0] - side * forward[1], ground[1] + side * forward[0], 0.002);
      foot.rotation.z = Math.atan2(forward[1], forward[0]);
    });
  }

  // Makes the floor translucent if a part of the scene is below it.
  setTranslucent(translucent: boolean) {
    for (const material of [this.floor.material, this.plateMaterial]) {
      material.transparent = translucent;
      material.opacity = translucent ? 0.35 : 1;
      material.depthWrite = !translucent;
      material.needsUpdate = true;
    }
  }

  paint(scene: Scene, theme: Theme) {
    const colors = kSceneColors[theme];
    scene.background = new Color(colors.background);
    scene.fog = new Fog(colors.background, 3, kFloorRadius);
    this.floor.material.color.set(colors.floor);
    this.plateMaterial.color.set(colors.minor);
    this.minor.material.color.set(colors.minor);
    this.major.material.color.set(colors.major);
    this.sky.intensity = colors.hemisphere;
    this.sun.intensity = colors.sun;
  }
}
