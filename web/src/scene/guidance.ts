// The circle to follow, the trail of the object and how far off it is now.
import {
  BufferGeometry, Float32BufferAttribute, Group, Line, LineBasicMaterial, Mesh, MeshBasicMaterial,
  SphereGeometry, TorusGeometry,
} from 'three';
import {SceneSpec, Vec3} from '../protocol';
import {hex, kSceneColors, Theme} from '../theme';
import {distance} from './frames';

const kTrailPoints = 900;
const kTrailStep = 0.003;  // between points of the trail [m]
const kJump = 0.1;         // the object was put somewhere else [m]

export class Guidance {
  readonly group = new Group();
  private spec: SceneSpec['guidance'] = {type: 'none', center: [0, 0, 0], radius: 0};
  private circle: Mesh<TorusGeometry, MeshBasicMaterial> | null = null;
  private readonly nearest = new Mesh(
      new SphereGeometry(0.012, 20, 14), new MeshBasicMaterial({color: 0xffffff}));
  private readonly points = new Float32Array(kTrailPoints * 3);
  private readonly geometry = new BufferGeometry();
  private readonly trail = new Line(this.geometry, new LineBasicMaterial({color: 0xffffff}));
  private count = 0;
  private last: Vec3 | null = null;

  constructor() {
    this.geometry.setAttribute('position', new Float32BufferAttribute(this.points, 3));
    this.geometry.setDrawRange(0, 0);
    this.trail.frustumCulled = false;
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

  // Shortest distance of `p` from the circle [m]; NaN without one.
  error(p: Vec3): number {
    return this.active ? distance(p, this.closest(p)) : NaN;
  }

  set(p: Vec3) {
    if (this.active) this.nearest.position.set(...this.closest(p));
  }

  // With each state, drawn or not: the trail is as fine on a slow computer.
  track(p: Vec3) {
    if (this.last && distance(this.last, p) > kJump) this.clear();
    if (this.last && distance(this.last, p) < kTrailStep) return;
    this.last = p;
    if (this.count === kTrailPoints) {
      this.points.copyWithin(0, 3);
      this.count--;
    }
    this.points.set(p, 3 * this.count++);
    const attribute = this.geometry.getAttribute('position') as Float32BufferAttribute;
    (attribute.array as Float32Array).set(this.points);
    attribute.needsUpdate = true;
    this.geometry.setDrawRange(0, this.count);
  }

  clear() {
    this.count = 0;
    this.last = null;
    this.geometry.setDrawRange(0, 0);
  }

  get trailLength(): number {
    return this.count;
  }

  setTrailVisible(visible: boolean) {
    this.trail.visible = visible;
  }

  paint(theme: Theme) {
    const color = hex(kSceneColors[theme].path);
    this.circle?.material.color.set(color);
    this.trail.material.color.set(theme === 'dark' ? '#ffd166' : '#c46b00');
    this.nearest.material.color.set(color);
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
