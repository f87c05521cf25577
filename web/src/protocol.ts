// What page and server say to one another (docs/viewer-protocol.md). Units are SI, the world frame W
// has Z up, quaternions are scalar first.

export type Vec3 = [number, number, number];
export type Quat = [number, number, number, number];
export type Side = 'left' | 'right';
export const kSides: readonly Side[] = ['left', 'right'];

export interface Pose {
  p: Vec3;
  q: Quat;
}

export interface RobotSpec {
  urdf: string;
  base: Pose;
  joints: string[];
  remove_links: string[];
  end_effector: string;
}

export interface ArmSpec extends RobotSpec {
  handle: Pose;
}

export type ObjectSpec = {urdf: string} | {shape: 'box' | 'cylinder' | 'sphere'; size: number[]};

export type ParameterName =
  | 'stiffness_translation'
  | 'stiffness_rotation'
  | 'damping_ratio'
  | 'force'
  | 'torque';
// In the order of a state's `parameters`.
export const kParameters: readonly ParameterName[] = [
  'stiffness_translation',
  'stiffness_rotation',
  'damping_ratio',
  'force',
  'torque',
];

export interface ParameterSpec {
  min: number;
  max: number;
  value: number;
}

export interface Action {
  action: string;
  start: number;
  duration: number;
  hand: string;
  text: string;
}

export interface SceneSpec {
  name: string;
  file?: string;  // of the scenario, without folder and ending; older servers do not tell
  mode: string;
  duration: number;
  simulated: boolean;
  operator: 'virtual' | 'browser' | 'person';
  rate: number;
  cobot: RobotSpec;
  object: ObjectSpec;
  handles: Record<Side, Pose | null>;
  arms: Record<Side, ArmSpec | null>;
  floor: boolean;
  table: {size: Vec3; top: Vec3} | null;
  guidance: {type: 'none' | 'circle'; center: Vec3; radius: number};
  thresholds: {
    force: number;
    torque: number;
    tracking: number;
    security_distance: number;
    influence_distance: number;
  };
  parameters: Partial<Record<ParameterName, ParameterSpec>>;
  script: Action[];
  scenarios: {name: string; title: string}[];  // that may be chosen in IDLE
  notice?: string;                             // what came of the last choice, if it failed
  replay?: {duration: number; first_tick: number};  // this is a recording [s]
}

export interface Leases {
  control: number | null;
  operator: number | null;
  clients: number;
}

export type Role = 'look' | 'operator' | 'control';

export interface Welcome {
  type: 'welcome';
  client: number;
  role: Role;
  token: string;
  server: string;
  server_ns: number;
  leases: Leases;
  scene: SceneSpec;
  frame: FrameField[];
  features?: string[];
}

export interface Headset {
  type: 'headset';
  client: number;
  active: boolean;
  p: Vec3;
  q: Quat;
}

export type ServerMessage =
  | Welcome
  | {type: 'refused'; reason: string}
  | ({type: 'leases'} & Leases)
  | {type: 'pong'; page_ms: number; server_ns: number}
  | {type: 'denied'; what: string; reason: string}
  | {type: 'notice'; text: string}
  | {type: 'ended'; text: string}
  | {type: 'token'; token: string}
  | Headset;

export type Credential = {code: string} | {pin: string} | {token: string};
export type Command = 'align' | 'start' | 'reset';

export type PageMessage =
  | ({type: 'hello'} & Credential)
  | {type: 'heartbeat'}
  | {type: 'lease'; what: 'control' | 'operator'; take: boolean}
  | {type: 'stop'}
  | {type: 'command'; command: Command}
  | {type: 'scenario'; name: string}
  | {type: 'mark'}
  | {type: 'replay'; play: number}
  | {type: 'replay'; seek: number}
  | {type: 'replay'; step: number}
  | {type: 'parameter'; parameter: ParameterName; value: number}
  | {type: 'hand'; hand: Side; grip: boolean; p: Vec3; q: Quat}
  | {type: 'ping'; page_ms: number}
  | {type: 'latency'; offset_ms: number; received_ms: number; rendered_ms: number}
  | {type: 'immersive'; active: boolean; drawn?: number; p?: Vec3; q?: Quat};

export const kSubprotocol = 'predictor.v1';

// ---- states ----------------------------------------------------------------------------------

export type FieldType = 'u8' | 'i8' | 'u16' | 'i32' | 'u32' | 'u64' | 'f32' | 'f64';

export interface FrameField {
  name: string;
  offset: number;
  type: FieldType;
  count: number;
}

export const kRunStates = [
  'INIT', 'SELFTEST', 'IDLE', 'ALIGN', 'ARMED', 'RUN', 'STOPPING', 'HELD', 'UNPOWERED', 'RECOVERY',
] as const;
export type RunState = (typeof kRunStates)[number];

export const kStopCauses = [
  'none', 'force', 'torque', 'sensor', 'stale', 'tracking', 'coupling', 'elbow', 'joint',
  'oscillation', 'qp', 'physics', 'deadline', 'device', 'operator', 'headset', 'enabling',
  'runaway',
] as const;
export type StopCause = (typeof kStopCauses)[number];

export const kQuantities = [
  'none', 'count', 'force', 'torque', 'length', 'angle', 'speed', 'angular_speed', 'time',
  'arm_age', 'sensor_age',
] as const;
export type Quantity = (typeof kQuantities)[number];

export const kStages = [
  'read', 'sense', 'simulate', 'render', 'monitor', 'guard', 'write', 'tick',
] as const;

export interface HandState {
  present: boolean;
  gripping: boolean;
  armFault: boolean;  // the arm reports a fault
  keepsPower: boolean;  // its power was to be cut, and it says that it has it still
  real: Pose;
  virtual: Pose;
  wrench: number[];
  peak: [number, number];  // largest force and torque since the state before [N], [N·m]
  coupling: number[];
  armQ: number[];
  manipulability: number;
  sensorAge: number;  // [s]; NaN if the server does not tell
}

// What is or was wrong, by how much of which limit.
export interface Reason {
  cause: StopCause;
  hand: Side | null;
  quantity: Quantity;
  value: number;
  limit: number;
}

export interface State {
  tick: number;
  runTime: number;
  wallNs: number;
  sentNs: number;
  state: RunState;
  stop: Reason;    // 'none' while nothing is stopped
  harder: Reason;  // what took the power off at the end of a stop that would have held
  action: number;
  cobotQ: number[];
  object: Pose;
  endEffector: Pose;
  hands: Record<Side, HandState>;
  elbowDistance: number;
  relativeSlack: number[];
  stageUs: number[];
  parameters: number[];
  qpRelaxed: boolean;
  qpFailed: boolean;
  guardAltered: boolean;
  recording: boolean;
}

const kReaders: Record<FieldType, [number, (view: DataView, at: number) => number]> = {
  u8: [1, (v, at) => v.getUint8(at)],
  i8: [1, (v, at) => v.getInt8(at)],
  u16: [2, (v, at) => v.getUint16(at, true)],
  i32: [4, (v, at) => v.getInt32(at, true)],
  u32: [4, (v, at) => v.getUint32(at, true)],
  u64: [8, (v, at) => Number(v.getBigUint64(at, true))],
  f32: [4, (v, at) => v.getFloat32(at, true)],
  f64: [8, (v, at) => v.getFloat64(at, true)],
};

function toPose(v: number[]): Pose {
  return {p: [v[0], v[1], v[2]], q: [v[3], v[4], v[5], v[6]]};
}

// Decodes states by the list of fields that the server sends, so that the two cannot drift apart.
export class StateDecoder {
  private readonly fields = new Map<string, FrameField>();
  private readonly size: number;

  // Throws an Error that names a type it does not know.
  constructor(frame: FrameField[]) {
    let size = 0;
    for (const field of frame) {
      if (!(field.type in kReaders)) throw new Error(`state field ${field.name}: ${field.type}?`);
      this.fields.set(field.name, field);
      size = Math.max(size, field.offset + kReaders[field.type][0] * field.count);
    }
    this.size = size;
  }

  // Throws an Error if the message is too short or lacks a field.
  decode(buffer: ArrayBuffer): State {
    if (buffer.byteLength < this.size) throw new Error('a state is shorter than its fields');
    const view = new DataView(buffer);
    const list = (name: string): number[] => {
      const field = this.fields.get(name);
      if (!field) throw new Error(`the server's states have no ${name}`);
      const [size, read] = kReaders[field.type];
      return Array.from({length: field.count}, (_, i) => read(view, field.offset + i * size));
    };
    const one = (name: string) => list(name)[0];
    const optional = (name: string) => (this.fields.has(name) ? one(name) : NaN);
    const hand = (side: Side): HandState => ({
      present: one(`${side}_present`) !== 0,
      gripping: one(`${side}_gripping`) !== 0,
      armFault: one(`${side}_arm_fault`) !== 0,
      keepsPower: one(`${side}_keeps_power`) !== 0,
      real: toPose(list(`${side}_real`)),
      virtual: toPose(list(`${side}_virtual`)),
      wrench: list(`${side}_wrench`),
      peak: (this.fields.has(`${side}_peak`) ? list(`${side}_peak`) : [NaN, NaN]) as [number, number],
      coupling: list(`${side}_coupling`),
      armQ: list(`${side}_arm_q`),
      manipulability: one(`${side}_manipulability`),
      sensorAge: optional(`${side}_sensor_age`),
    });
    const reason = (prefix: string): Reason => ({
      cause: kStopCauses[one(`${prefix}cause`)] ?? 'none',
      hand: ([null, 'left', 'right'] as const)[one(`${prefix}cause_hand`) + 1] ?? null,
      quantity: kQuantities[one(`${prefix}cause_quantity`)] ?? 'none',
      value: one(`${prefix}cause_value`),
      limit: one(`${prefix}cause_limit`),
    });
    return {
      tick: one('tick'),
      runTime: one('run_time'),
      wallNs: one('wall_ns'),
      sentNs: one('sent_ns'),
      state: kRunStates[one('state')] ?? 'INIT',
      stop: reason(''),
      harder: reason('harder_'),
      action: one('action'),
      cobotQ: list('cobot_q'),
      object: toPose(list('object')),
      endEffector: toPose(list('end_effector')),
      hands: {left: hand('left'), right: hand('right')},
      elbowDistance: one('elbow_distance'),
      relativeSlack: list('relative_slack'),
      stageUs: list('stage_us'),
      parameters: list('parameters'),
      qpRelaxed: one('qp_relaxed') !== 0,
      qpFailed: one('qp_failed') !== 0,
      guardAltered: one('guard_altered') !== 0,
      recording: one('recording') !== 0,
    };
  }
}

// Which scenario it is: titles may be alike, files of one folder are not.
export function scenarioOf(spec: SceneSpec): string {
  return spec.file ?? spec.name;
}

// Stamp of a state on the server's clock [ms]: of its tick, or, in virtual time, of its sending.
export function stampMs(state: State): number {
  return (state.wallNs > 0 ? state.wallNs : state.sentNs) / 1e6;
}
