// Shows the circle that the person must follow, the trail of the object, and the object's present
// distance from the circle.
import {
  BufferGeometry, Color, Float32BufferAttribute, Group, Line, LineBasicMaterial, Mesh,
  MeshBasicMaterial, Points, PointsMaterial, SphereGeometry, TorusGeometry,
} from 'three';
import {SceneSpec, Vec3} from '../protocol';
import {hex, kMeaning, kSceneColors, Theme} from '../theme';
import {distance} from './frames';

const kTrailPoints = 900;
const kTrailStep = 0.003;  // distance between points of the trail [m]
const kJump = 0.1;         // a longer step means that the object was placed elsewhere [m]
const kFarOff = 0.03;      // distance from the path at which the trail's colour stops changing [m]
const kMarks = 120;
const kMarkEvery = 1;      // run time between two marks [s]

// The latest positions of the object, from the oldest to the newest.
class Places {
  readonly geometry = new BufferGeometry();
  count = 0;
  private readonly position: Float32BufferAttribute;
  private readonly color: Float32BufferAttribute;

  constructor(private readonly most: number) {
    this.position = new Float32BufferAttribute(3 * most, 3);
    this.color = new Float32BufferAttribute(3 * most, 3);
    this.geometry.setAttribute('position', this.position);
    this.geometry.setAttribute('color', this.color);
    this.clear();
  }

  add(p: Vec3, color: Color) {
    if (this.count === this.most) {
      this.position.array.copyWithin(0, 3);
      this.color.array.copyWithin(0, 3);
      this.count--;
    }
    this.position.setXYZ(this.count, ...p);
    this.color.setXYZ(this.count++, color.r, color.g, color.b);
    this.position.needsUpdate = true;
    this.color.needsUpdate = true;
    this.geometry.setDrawRange(0, this.count);
  }

  clear() {
    this.count = 0;
    this.geometry.setDrawRange(0, 0);
  }
}

export class Guidance {
  readonly group = new Group();
  private spec: SceneSpec['guidance'] = {type: 'none', center: [0, 0, 0], radius: 0};
  private circle: Mesh<TorusGeometry, MeshBasicMaterial> | null = null;
  private readonly nearest = new Mesh(
      new SphereGeometry(0.012, 20, 14), new MeshBasicMaterial({color: 0xffffff}));
  // The trail, coloured by its distance from the path, with a mark for each second.
  private readonly way = new Places(kTrailPoints);
  private readonly marks = new Places(kMarks);
  private readonly trail = new Group();
  private readonly color = new Color();
  private theme: Theme = 'dark';
  private last: Vec3 | null = null;
  private lastMark = NaN;

  constructor() {
    const line = new Line(this.way.geometry, new LineBasicMaterial({vertexColors: true}));
    const points = new Points(
        this.marks.geometry, new PointsMaterial({vertexColors: true, size: 0.012}));
    line.frustumCulled = false;
    points.frustumCulled = false;
    this.trail.add(line, points);
    this.nearest.visible = false;
    this.group.add(this.trail, this.nearest);
  }

  get active(): boolean {
    return this.spec.type === 'circle';
  }

  build(spec: SceneSpec) {
    this.spec = spec.guidance;
    this.circle?.removeFromParent();
    this.circle = null;
    this.nearest.visible = this.active;
    this.clear();
    if (!this.active) return;
    this.circle = new Mesh(
        new TorusGeometry(this.spec.radius, 0.004, 10, 128), new MeshBasicMaterial());
    this.circle.position.set(...this.spec.center);
    this.group.add(this.circle);
  }

  // Returns the shortest distance of `p` from the circle [m], or NaN if there is no circle.
  error(p: Vec3): number {
    return this.active ? distance(p, this.closest(p)) : NaN;
  }

  set(p: Vec3) {
    if (this.active) this.nearest.position.set(...this.closest(p));
  }

  // This function is called for each state, even if the state is not drawn, so that the trail has
  // the same resolution on a slow computer.
  track(p: Vec3, runTime: number) {
    if (this.last && distance(this.last, p) > kJump) this.clear();
    if (this.last && distance(this.last, p) < kTrailStep) return;
    const color = this.colorAt(p);
    this.last = p;
    this.way.add(p, color);
    const second = Math.floor(runTime / kMarkEvery);
    if (second !== this.lastMark) this.marks.add(p, color);
    this.lastMark = second;
  }

  clear() {
    this.way.clear();
    this.marks.clear();
    this.last = null;
    this.lastMark = NaN;
  }

  get trailLength(): number {
    return this.way.count;
  }

  get trailMarks(): number {
    return this.marks.count;
  }

  setTrailVisible(visible: boolean) {
    this.trail.visible = visible;
  }

  paint(theme: Theme) {
    const color = hex(kSceneColors[theme].path);
    this.theme = theme;
    this.circle?.material.color.set(color);
    this.nearest.material.color.set(color);
  }

  // On the path, the trail has the colour of small hand forces. As the distance grows, the colour
  // changes towards red. Without a path, the colour is constant.
  private colorAt(p: Vec3): Color {
    if (!this.active) return this.color.set(this.theme === 'dark' ? '#ffd166' : '#c46b00');
    const off = Math.min(this.error(p) / kFarOff, 1);
    const [from, to] = off < 0.5 ? [kMeaning.green, kMeaning.orange] : [kMeaning.orange, kMeaning.red];
    return this.color.set(from).lerp(new Color(to), off < 0.5 ? 2 * off : 2 * off - 1);
  }

  private closest(p: Vec3): Vec3 {
    const {center, radius} = this.spec;
    const dx = p[0] - center[0];
    const dy = p[1] - center[1];
    const d = Math.hypot(dx, dy);
    const [ux, uy] = d > 1e-9 ? [dx / d, dy / d] : [1, 0];
    return [center[0] + radius * ux, center[1] + radius * uy, center[2]];
  }
}
