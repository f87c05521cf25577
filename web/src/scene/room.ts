// Floor, grid, table and light.
import {
  BoxGeometry, BufferGeometry, CircleGeometry, Color, DirectionalLight, Float32BufferAttribute, Fog,
  Group, HemisphereLight, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial,
  MeshStandardMaterial, Scene,
} from 'three';
import {SceneSpec} from '../protocol';
import {kSceneColors, Theme} from '../theme';

const kFloorRadius = 6;   // [m]
const kGridHalf = 3;      // [m]
const kGridStep = 0.1;    // [m]
const kMajorEvery = 5;    // lines

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

export class Room {
  readonly group = new Group();
  private readonly floor = new Mesh(
      new CircleGeometry(kFloorRadius, 64), new MeshLambertMaterial());
  private readonly minor = new LineSegments(gridLines(true), new LineBasicMaterial());
  private readonly major = new LineSegments(gridLines(false), new LineBasicMaterial());
  private readonly sky = new HemisphereLight(0xffffff, 0x8a94a3);
  private readonly sun = new DirectionalLight(0xffffff);
  private readonly fill = new DirectionalLight(0xbdd4ff, 0.6);
  private table: Mesh | null = null;

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
    this.group.add(
        this.floor, this.minor, this.major, this.sky, this.sun, this.sun.target,
        this.fill);
  }

  build(spec: SceneSpec) {
    this.floor.visible = spec.floor;
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

  // Makes the floor translucent if there is something below it.
  setTranslucent(translucent: boolean) {
    const material = this.floor.material;
    material.transparent = translucent;
    material.opacity = translucent ? 0.35 : 1;
    material.depthWrite = !translucent;
    material.needsUpdate = true;
  }

  paint(scene: Scene, theme: Theme) {
    const colors = kSceneColors[theme];
    scene.background = new Color(colors.background);
    scene.fog = new Fog(colors.background, 3, kFloorRadius);
    this.floor.material.color.set(colors.floor);
    this.minor.material.color.set(colors.minor);
    this.major.material.color.set(colors.major);
    this.sky.intensity = colors.hemisphere;
    this.sun.intensity = colors.sun;
  }
}
