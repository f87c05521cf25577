// Shows the handles. Virtual handles are solid and real handles are outlines, so that the distance
// between them is visible.
import {
  AxesHelper, CapsuleGeometry, CylinderGeometry, EdgesGeometry, Group, LineBasicMaterial,
  LineSegments, Mesh, MeshStandardMaterial, SphereGeometry, TorusGeometry,
} from 'three';
import {HandState, Side} from '../protocol';
import {kMeaning} from '../theme';
import {place} from './frames';

const kRadius = 0.018;      // radius of the grip [m]
const kLength = 0.11;       // [m]
const kRingRadius = 0.042;  // around the grip, visible even if a body hides the grip [m]
const kShineThrough = 10;  // order of drawing
const kPickRadius = 0.07;  // generous, for fingers on a tablet [m]
const kMinRingRadius = 20;  // minimum radius on the page of a ring that can be dragged [px]
const kMaxScale = 2;       // maximum scaling for that purpose
const kPulseMs = 1100;     // period of an inviting ring's pulse

export class Handle {
  readonly group = new Group();
  readonly virtual = new Group();
  readonly real = new Group();
  // This invisible sphere detects whether the pointer hits the handle.
  readonly target = new Mesh(new SphereGeometry(kPickRadius, 12, 8));
  private readonly material: MeshStandardMaterial;
  private readonly halo: Mesh<TorusGeometry, MeshStandardMaterial>;
  private readonly rings = new Group();  // enlarged if they would be small on the page
  private isHeld = false;
  private isHovered = false;

  constructor(readonly side: Side) {
    const color = kMeaning[side];
    this.material = new MeshStandardMaterial({color, roughness: 0.35, emissive: color});
    // The grip lies along Y, like a bar in a hand whose fingers close around it from below.
    const grip = new Mesh(new CapsuleGeometry(kRadius, kLength - 2 * kRadius, 8, 24), this.material);
    grip.castShadow = true;
    const ring = new Mesh(new TorusGeometry(kRingRadius, 0.007, 12, 48), this.material);
    ring.castShadow = true;
    this.halo = new Mesh(
        new TorusGeometry(0.062, 0.004, 8, 48),
        new MeshStandardMaterial({color, emissive: color, emissiveIntensity: 0.8}));
    this.halo.visible = false;
    this.target.visible = false;
    this.rings.add(ring, this.halo, this.target, ...this.hints([ring]));
    this.virtual.add(grip, this.rings, ...this.hints([grip]));
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

  // If another object hides the handle, a faint copy of the handle shines through.
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

  setHeld(on: boolean) {
    this.isHeld = on;
  }

  // Determines whether the handle is shown as one over which the pointer is and which the pointer
  // may take.
  setHovered(on: boolean) {
    this.isHovered = on;
  }

  // Shows a second ring around the handle. The ring pulses while it invites the visitor. The ring
  // is bright while the pointer is over the handle and while the handle is held.
  invite(on: boolean, nowMs: number) {
    this.halo.visible = on || this.isHovered || this.isHeld;
    const still = this.isHovered || this.isHeld || matchMedia('(prefers-reduced-motion: reduce)').matches;
    const beat = still ? 1 : 0.5 + 0.5 * Math.sin((2 * Math.PI * nowMs) / kPulseMs);
    this.halo.scale.setScalar(still ? 1.06 : 0.96 + 0.2 * beat);
    this.halo.material.emissiveIntensity = still ? 1.2 : 0.5 + 0.7 * beat;
  }

  // The radius of the ring as drawn [m].
  get ringRadius(): number {
    return kRingRadius * this.rings.scale.x;
  }

  // `pixelsPerMetre` is the scale of the picture at the handle. If this scale is infinite, the
  // handle has its true size.
  setScreenScale(pixelsPerMetre: number) {
    const scale = kMinRingRadius / (kRingRadius * pixelsPerMetre);
    this.rings.scale.setScalar(Math.min(Math.max(scale, 1), kMaxScale));
  }
}
