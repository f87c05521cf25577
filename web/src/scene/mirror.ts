// Shows a mirror in the scene, in which people see their own body at half its size.
import {DoubleSide, EdgesGeometry, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, PlaneGeometry} from 'three';
import {BodyPoints, mirrored, MirrorPlace} from '../person';
import {PersonState, SceneSpec, Vec3} from '../protocol';
import {Body} from './body';

const kScale = 0.5;
const kAhead = 1.1, kRight = 0.85, kAboveGround = 0.72;  // offset of the figure's feet from the person's [m]
const kBehind = 0.22;  // distance of the glass behind the figure [m]
const kWidth = 0.8, kHeight = 1.15;  // size of the glass [m]

export class Mirror {
  readonly group = new Group();
  readonly body = new Body(kScale);
  private readonly glass = new Group();
  private spec: SceneSpec | null = null;
  private place: MirrorPlace | null = null;

  constructor() {
    const plane = new PlaneGeometry(kWidth, kHeight);
    this.glass.add(
        new Mesh(plane, new MeshBasicMaterial(
            {color: 0x24405f, transparent: true, opacity: 0.45, depthWrite: false, side: DoubleSide, fog: false})),
        new LineSegments(new EdgesGeometry(plane), new LineBasicMaterial({color: 0x7cc0ff, fog: false})));
    // This rotation turns the plane's axes, in which y is up and the plane faces z, to the axes of
    // W.
    this.glass.rotation.set(Math.PI / 2, 0, 0, 'ZXY');
    this.group.add(this.glass, this.body.group);
    this.group.visible = false;
  }

  build(spec: SceneSpec) {
    this.spec = spec;
    const {ground, forward} = spec.viewpoint;
    if (!ground) return;
    const toward: Vec3 = [kAhead * forward[0] + kRight * forward[1], kAhead * forward[1] - kRight * forward[0], 0];
    const length = Math.hypot(...toward);
    const at: Vec3 = [ground[0] + toward[0], ground[1] + toward[1], ground[2] + kAboveGround];
    toward.forEach((x, i) => (toward[i] = x / length));
    this.place = {at, toward, scale: kScale};
    this.glass.position.set(at[0] + kBehind * toward[0], at[1] + kBehind * toward[1], at[2] + kHeight / 2 - 0.1);
    this.glass.rotation.z = Math.atan2(toward[1], toward[0]) - Math.PI / 2;
  }

  // `points` are the body's points in W, or null if the body is not known.
  set(points: BodyPoints | null, parts: PersonState['parts'] | null) {
    const ground = this.spec?.viewpoint.ground;
    this.body.group.visible = points !== null && !!ground;
    if (!points || !ground || !this.place) return;
    this.body.set(mirrored(points, ground, this.spec!.viewpoint.forward, this.place));
    this.body.paint(parts);
  }
}
