// Handles: virtual ones solid, real ones as outlines, so that one sees where they part.
import {
  AxesHelper, CapsuleGeometry, CylinderGeometry, EdgesGeometry, Group, LineBasicMaterial,
  LineSegments, Mesh, MeshStandardMaterial, SphereGeometry, TorusGeometry,
} from 'three';
import {HandState, Side} from '../protocol';
import {kMeaning} from '../theme';
import {place} from './frames';

const kRadius = 0.018;      // of the grip [m]
const kLength = 0.11;       // [m]
const kRingRadius = 0.042;  // around the grip, to be seen also where the grip is inside a body [m]
const kShineThrough = 10;  // order of drawing
const kPickRadius = 0.07;  // generous, for fingers on a tablet [m]

export class Handle {
  readonly group = new Group();
  readonly virtual = new Group();
  readonly real = new Group();
  // Invisible; what pointers are tried against.
  readonly target = new Mesh(new SphereGeometry(kPickRadius, 12, 8));
  private readonly material: MeshStandardMaterial;
  private readonly halo: Mesh<TorusGeometry, MeshStandardMaterial>;

  constructor(readonly side: Side) {
    const color = kMeaning[side];
    this.material = new MeshStandardMaterial({color, roughness: 0.35, emissive: color});
    // Along Y, as a bar held by a hand whose fingers close around it from below.
    const grip = new Mesh(new CapsuleGeometry(kRadius, kLength - 2 * kRadius, 8, 24), this.material);
    grip.castShadow = true;
    const ring = new Mesh(new TorusGeometry(kRingRadius, 0.007, 12, 48), this.material);
    ring.castShadow = true;
    this.halo = new Mesh(
        new TorusGeometry(0.062, 0.004, 8, 48),
        new MeshStandardMaterial({color, emissive: color, emissiveIntensity: 0.8}));
    this.halo.visible = false;
    this.target.visible = false;
    this.virtual.add(grip, ring, this.halo, this.target, ...this.hints([grip, ring]));
    const outline = new LineSegments(
        new EdgesGeometry(new CylinderGeometry(kRadius * 1.4, kRadius * 1.4, kLength * 1.1, 10), 1),
        new LineBasicMaterial({color, transparent: true, opacity: 0.9}));
    this.real.add(outline, new AxesHelper(0.05));
    this.group.add(this.virtual, this.real);
    this.group.visible = false;
  }

  set(hand: HandState, showReal: boolean) {
    this.group.visible = hand.present;
    place(this.virtual, hand.virtual);
    place(this.real, hand.real);
    this.real.visible = showReal;
    this.material.emissiveIntensity = hand.gripping ? 0.55 : 0.12;
  }

  // Where something hides the handle, a hint of it shines through.
  private hints(meshes: Mesh[]): Mesh[] {
    const material = new MeshStandardMaterial({
      color: kMeaning[this.side], emissive: kMeaning[this.side], emissiveIntensity: 0.4,
      transparent: true, opacity: 0.35, depthTest: false, depthWrite: false,
    });
    return meshes.map((mesh) => {
      const hint = new Mesh(mesh.geometry, material);
      hint.renderOrder = kShineThrough;
      return hint;
    });
  }

  // A ring that says: this one can be taken, or is held.
  setHighlight(on: boolean) {
    this.halo.visible = on;
  }
}
