// A common interface to the headset's controllers and tracked hands. This interface provides the
// poses and touching points of controllers and hands, and states whether they are closed.
import {
  BufferGeometry, CapsuleGeometry, Group, InstancedMesh, Line, LineBasicMaterial, Matrix4, Mesh,
  MeshStandardMaterial, Quaternion, SphereGeometry, Vector3,
} from 'three';
import {Side} from '../protocol';

const kStopButton = 5;      // B or Y of common controllers
const kThumbstickAxis = 3;  // vertical
const kMaxJoints = 25;

export interface Input {
  source: XRInputSource;
  side: Side | null;
  grip: Matrix4;       // pose in the headset's space, three.js's axes
  tip: Vector3;        // point with which it touches
  ray: {origin: Vector3; direction: Vector3} | null;
  closed: boolean;     // trigger, squeeze or pinch
  closing: boolean;    // became closed in this frame
  stick: number;       // thumbstick, up is positive, −1 … 1
}

interface Held {
  select: boolean;
  squeeze: boolean;
  wasClosed: boolean;
  wasStop: boolean;  // the stop button was pressed in the previous frame
}

function position(pose: XRPose | XRJointPose): Vector3 {
  const {x, y, z} = pose.transform.position;
  return new Vector3(x, y, z);
}

function rotation(pose: XRPose): Quaternion {
  const {x, y, z, w} = pose.transform.orientation;
  return new Quaternion(x, y, z, w);
}

export class Inputs {
  readonly group = new Group();  // their drawings, in the headset's space
  private readonly held = new Map<XRInputSource, Held>();
  private readonly bodies = {left: new Body(), right: new Body()};

  constructor() {
    this.group.add(this.bodies.left.group, this.bodies.right.group);
  }

  listen(session: XRSession) {
    const set = (key: 'select' | 'squeeze', value: boolean) => (event: XRInputSourceEvent) => {
      this.heldBy(event.inputSource)[key] = value;
    };
    session.addEventListener('selectstart', set('select', true));
    session.addEventListener('selectend', set('select', false));
    session.addEventListener('squeezestart', set('squeeze', true));
    session.addEventListener('squeezeend', set('squeeze', false));
    session.addEventListener('inputsourceschange', (event) => {
      event.removed.forEach((source) => this.held.delete(source));
    });
  }

  clear() {
    this.held.clear();
    this.bodies.left.hide();
    this.bodies.right.hide();
  }

  // Returns whether a stop button was pressed, even if no controller can be tracked.
  stopPressed(session: XRSession): boolean {
    let pressed = false;
    for (const source of session.inputSources) {
      const held = this.heldBy(source);
      const stop = source.gamepad?.buttons[kStopButton]?.pressed ?? false;
      pressed ||= stop && !held.wasStop;
      held.wasStop = stop;
    }
    return pressed;
  }

  read(frame: XRFrame, space: XRReferenceSpace): Input[] {
    const inputs: Input[] = [];
    for (const source of frame.session.inputSources) {
      const input = this.readOne(frame, space, source);
      if (input) inputs.push(input);
    }
    for (const side of ['left', 'right'] as const) {
      const input = inputs.find((i) => i.side === side);
      this.bodies[side].show(input ?? null, frame, space);
    }
    return inputs;
  }

  private readOne(frame: XRFrame, space: XRReferenceSpace, source: XRInputSource): Input | null {
    const ray = frame.getPose(source.targetRaySpace, space);
    const grip = (source.gripSpace && frame.getPose(source.gripSpace, space)) ?? ray;
    if (!grip) return null;
    const finger = this.joint(frame, space, source, 'index-finger-tip');
    const thumb = this.joint(frame, space, source, 'thumb-tip');
    const at = finger && thumb ? finger.clone().lerp(thumb, 0.5) : position(grip);
    const held = this.heldBy(source);
    const closed = held.select || held.squeeze;
    const input: Input = {
      source,
      side: source.handedness === 'none' ? null : source.handedness,
      grip: new Matrix4().compose(at, rotation(grip), new Vector3(1, 1, 1)),
      tip: finger ?? (ray ? position(ray) : at),
      ray: ray ? {
        origin: position(ray), direction: new Vector3(0, 0, -1).applyQuaternion(rotation(ray)),
      } : null,
      closed,
      closing: closed && !held.wasClosed,
      stick: -(source.gamepad?.axes[kThumbstickAxis] ?? 0),
    };
    held.wasClosed = closed;
    return input;
  }

  private joint(frame: XRFrame, space: XRReferenceSpace, source: XRInputSource,
                name: XRHandJoint): Vector3 | null {
    const joint = source.hand?.get(name);
    const pose = joint && frame.getJointPose?.(joint, space);
    return pose ? position(pose) : null;
  }

  private heldBy(source: XRInputSource): Held {
    let held = this.held.get(source);
    if (!held) {
      held = {select: false, squeeze: false, wasClosed: false, wasStop: false};
      this.held.set(source, held);
    }
    return held;
  }
}

// A plain shape that shows the person where a controller or hand is.
class Body {
  readonly group = new Group();
  private readonly material = new MeshStandardMaterial({color: 0xdfe6ee, roughness: 0.6});
  private readonly controller = new Mesh(
      new CapsuleGeometry(0.017, 0.09, 6, 16).rotateX(Math.PI / 2), this.material);
  private readonly joints = new InstancedMesh(
      new SphereGeometry(0.008, 12, 8), this.material, kMaxJoints);
  private readonly ray = new Line(
      new BufferGeometry().setFromPoints([new Vector3(), new Vector3(0, 0, -0.5)]),
      new LineBasicMaterial({color: 0x9fc6ff, transparent: true, opacity: 0.5}));

  constructor() {
    this.controller.matrixAutoUpdate = false;
    this.joints.frustumCulled = false;
    this.group.add(this.controller, this.joints, this.ray);
    this.hide();
  }

  hide() {
    this.group.visible = false;
  }

  show(input: Input | null, frame: XRFrame, space: XRReferenceSpace) {
    this.group.visible = input !== null;
    if (!input) return;
    this.material.emissive.set(input.closed ? 0x2f6fb5 : 0x000000);
    const hand = input.source.hand;
    this.controller.visible = !hand;
    this.ray.visible = !hand && input.ray !== null;
    this.joints.visible = !!hand;
    this.controller.matrix.copy(input.grip);
    if (input.ray) {
      this.ray.position.copy(input.ray.origin);
      this.ray.quaternion.setFromUnitVectors(new Vector3(0, 0, -1), input.ray.direction);
    }
    if (hand) this.showJoints(hand, frame, space);
  }

  private showJoints(hand: XRHand, frame: XRFrame, space: XRReferenceSpace) {
    let count = 0;
    for (const joint of hand.values()) {
      const pose = frame.getJointPose?.(joint, space);
      if (pose && count < kMaxJoints) {
        this.joints.setMatrixAt(count++, new Matrix4().setPosition(position(pose)));
      }
    }
    this.joints.count = count;
    this.joints.instanceMatrix.needsUpdate = true;
  }
}
