// Messages between page and server (docs/reference/viewer-protocol.md). Units are SI, the world
// frame W has Z up, and quaternions have the scalar first.

import {PersonState} from './person_state';
import {Pose, Quat, Side, Vec3} from './pose';
import {
  HandQuantities, kHandFields, kQuantities, kRunFields, kRunStates, kStopCauses, ParameterName,
  Quantity, RunQuantities, StopCause,
} from './quantities';

export * from './person_state';
export * from './pose';
export * from './quantities';

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

// The colour consists of red, green and blue, each from 0 to 1.
export type ObjectSpec =
    {urdf: string} | {shape: 'box' | 'cylinder' | 'sphere'; size: number[]; color?: Vec3};
// A movable object. The states contain the pose of this body.
export type MovableSpec = ObjectSpec & {name: string};

// The dimensions [m]. The sizes are x, y, z of a box, the radius and the length along z of a
// cylinder or capsule (without the caps), the radius of a sphere, or x, y of a plane whose normal
// is along z. The colour consists of red, green and blue, each from 0 to 1.
export interface FixtureSpec {
  shape: 'box' | 'cylinder' | 'capsule' | 'sphere' | 'plane';
  size: Vec3;
  pose: Pose;
  color: Vec3;
  keep_out?: true;  // a volume that the cobot must not enter
  name?: string;    // of a keep-out volume that has one
}

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
  file?: string;  // file of the scenario, without folder and extension; older servers omit it
  mode: string;
  duration: number;  // [s]; 0: until a person ends it
  simulated: boolean;
  operator: 'virtual' | 'browser' | 'person';
  rate: number;
  // The operator in W. The values are the eyes at the start, the horizontal direction of view, and
  // the ground between the feet. The distance between the feet is `feet` [m]. If the ground is
  // missing, the other values are assumptions.
  viewpoint: {eye: Vec3; forward: Vec3; guess: boolean; ground: Vec3 | null; feet: number};
  cobot: RobotSpec;
  object: ObjectSpec;
  handles: Record<Side, Pose | null>;
  arms: Record<Side, ArmSpec | null>;
  floor: boolean;
  table: {size: Vec3; top: Vec3} | null;
  fixtures?: FixtureSpec[];  // those that are there now; older servers omit them
  movables?: MovableSpec[];  // older servers omit them
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
  acting?: string[];  // what each acting event does, the newest last; older servers omit it
  scenarios: {name: string; title: string}[];  // scenarios that may be chosen at rest
  notice?: string;                             // error of the last choice, if it failed
  person?: {judged: boolean; why?: string};        // whether messages `person` come; older servers omit it
  replay?: {duration: number; first_tick: number};  // present for a recording [s]
  results?: Results;                                // present after the end of the run
}

// A result of a run, given as one number or as one number per hand.
export interface Figure {
  name: string;
  value?: string;
  left?: string;
  right?: string;
}

// The largest value in each interval of `step` seconds.
export interface Curve {
  title: string;
  unit: string;
  limit: number;
  step: number;
  left: number[] | null;
  right: number[] | null;
}

export interface Results {
  how: string;        // how the run ended, as a sentence
  figures: Figure[];
  curves: Curve[];
  recording: string;  // the recording's file; empty: no recording
  remark: string;     // why there is no report, or empty
  report?: string;    // path on the server
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

// An entry of the scenario's events.
export interface PlannedEvent {
  event: string;    // the hazard's name
  meaning: string;  // what happens
  trigger: string;  // when it begins, in words
  begin: number | null;  // run time at which it began [s]; null: it is still to come
  end: number | null;    // run time at which it ended [s]
}

export interface EventPlan {
  type: 'events';
  complete: boolean;  // false: events that ended before the server restarted are not known
  events: PlannedEvent[];
}

export type ServerMessage =
  | Welcome
  | {type: 'refused'; reason: string}
  | ({type: 'leases'} & Leases)
  | {type: 'pong'; page_ms: number; server_ns: number}
  | {type: 'denied'; what: string; reason: string}
  | {type: 'notice'; text: string}
  | {type: 'ended'; text: string; results_follow?: boolean}
  | {type: 'token'; token: string}
  | Headset
  | {type: 'fixtures'; fixtures: FixtureSpec[]}
  | {type: 'acting'; acting: string[]}
  | EventPlan
  | PersonState;

export type Credential = {code: string} | {pin: string} | {token: string};
export type Command = 'align' | 'start' | 'end' | 'reset';

export type PageMessage =
  | ({type: 'hello'} & Credential)
  | {type: 'heartbeat'}
  | {type: 'lease'; what: 'control' | 'operator'; take: boolean}
  | {type: 'stop'}
  | {type: 'experimenter'}
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
  | {type: 'immersive'; active: boolean; drawn?: number; p?: Vec3; q?: Quat;
     posed?: number; registration?: {yaw: number; t: Vec3; residual: number}};

export const kSubprotocol = 'predictor.v1';

// ---- states ----------------------------------------------------------------------------------

export type FieldType = 'u8' | 'i8' | 'u16' | 'i32' | 'u32' | 'u64' | 'f32' | 'f64';

export interface FrameField {
  name: string;
  offset: number;
  type: FieldType;
  count: number;
}

export interface HandState extends HandQuantities {}

// A fault, with its value and the limit that it exceeded.
export interface Reason {
  cause: StopCause;
  hand: Side | null;
  quantity: Quantity;
  value: number;
  limit: number;
}

export interface State extends RunQuantities {
  stop: Reason;    // 'none' unless a stop occurred
  harder: Reason;  // fault that escalated the stop from hold to power-off
  hands: Record<Side, HandState>;
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

const kPoseNumbers = 7;

function toPoses(v: number[]): Pose[] {
  return Array.from({length: v.length / kPoseNumbers},
                    (_, i) => toPose(v.slice(kPoseNumbers * i, kPoseNumbers * (i + 1))));
}

const kConvert: Record<string, (v: number[]) => unknown> = {
  number: (v) => v[0],
  numbers: (v) => v,
  flag: (v) => v[0] !== 0,
  pose: toPose,
  poses: toPoses,
  state: (v) => kRunStates[v[0]] ?? 'INIT',
  cause: (v) => kStopCauses[v[0]] ?? 'none',
  quantity: (v) => kQuantities[v[0]] ?? 'none',
};

function toReason(cause: StopCause, hand: number, quantity: Quantity, value: number,
                  limit: number): Reason {
  return {cause, hand: ([null, 'left', 'right'] as const)[hand + 1] ?? null, quantity, value, limit};
}

// Decodes states by the server's list of fields, so that page and server always agree.
export class StateDecoder {
  private readonly fields = new Map<string, FrameField>();
  private readonly size: number;

  // Throws an Error that names an unknown type.
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
    const read = (fields: typeof kRunFields | typeof kHandFields, prefix: string) =>
        Object.fromEntries(Object.entries(fields).map(
            ([name, [key, kind]]) => [key, kConvert[kind](list(prefix + name))]));
    const run = read(kRunFields, '') as unknown as RunQuantities;
    const hand = (side: Side) => read(kHandFields, `${side}_`) as unknown as HandState;
    return {
      ...run,
      stop: toReason(run.cause, run.causeHand, run.causeQuantity, run.causeValue, run.causeLimit),
      harder: toReason(run.harderCause, run.harderCauseHand, run.harderCauseQuantity,
                       run.harderCauseValue, run.harderCauseLimit),
      hands: {left: hand('left'), right: hand('right')},
    };
  }
}

// Identifies the scenario. Two scenarios may have the same title, but files in one folder have
// different names.
export function scenarioOf(spec: SceneSpec): string {
  return spec.file ?? spec.name;
}

// Returns the time stamp of a state on the server's clock [ms]. This is the start of the state's
// tick or, in virtual time, the time of sending.
export function stampMs(state: State): number {
  return (state.wallNs > 0 ? state.wallNs : state.sentNs) / 1e6;
}
