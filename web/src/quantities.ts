// Generated from src/core/tick_fields.h: build/release/bin/page_quantities writes this file.

import type {Pose} from './pose';

export const kRunStates = [
  'INIT', 'SELFTEST', 'IDLE', 'ALIGN', 'ARMED', 'RUN',
  'STOPPING', 'HELD', 'UNPOWERED', 'RECOVERY',
] as const;
export type RunState = (typeof kRunStates)[number];

export const kStopCauses = [
  'none', 'force', 'torque', 'sensor', 'stale', 'tracking',
  'coupling', 'elbow', 'joint', 'oscillation', 'qp', 'physics',
  'deadline', 'device', 'operator', 'headset', 'enabling', 'runaway',
  'watchdog',
] as const;
export type StopCause = (typeof kStopCauses)[number];

export const kQuantities = [
  'none', 'count', 'force', 'torque', 'length', 'angle',
  'speed', 'angular_speed', 'time', 'arm_age', 'sensor_age', 'vibration',
  'acceleration', 'angular_acceleration', 'not_finite', 'allocations',
] as const;
export type Quantity = (typeof kQuantities)[number];

export const kStages = [
  'read', 'sense', 'simulate', 'render', 'monitor', 'guard',
  'write', 'tick',
] as const;

export const kParameters = [
  'stiffness_translation', 'stiffness_rotation', 'damping_ratio', 'force', 'torque',
] as const;
export type ParameterName = (typeof kParameters)[number];

export interface RunQuantities {
  tick: number;  // counts from process start
  runTime: number;  // [s] simulated time since RUN began
  wallNs: number;  // [ns] monotonic clock at the tick's start; 0 in virtual time
  state: RunState;  // state of the run
  cause: StopCause;  // cause of the stop, until reset
  causeHand: number;  // 0 left, 1 right, -1 neither or both
  action: number;  // index in the operator's script; -1 none
  causeValue: number;  // measured value of the cause, SI
  causeLimit: number;  // limit of that value, SI
  causeQuantity: Quantity;  // quantity of that value and limit
  events: number;  // bits: active entries of the scenario's events
  latestEvent: number;  // 1 + number of the hazard that began last; 0 none
  cobotStop: number;  // protective stop of the virtual cobot itself: 0 none, then: force, speed, momentum, joint torque (in a prismatic joint: force)
  attachment: number;  // the cobot's grip on the object: 0 holds, 1 slips, 2 open, 3 open, because the object was too far away to be grasped
  harderCause: StopCause;
  harderCauseHand: number;  // 0 left, 1 right, -1 neither or both
  harderCauseQuantity: Quantity;  // quantity of that value and limit
  harderCauseValue: number;  // measured value of the cause, SI
  harderCauseLimit: number;  // limit of that value, SI
  parameters: number[];  // factors of translational stiffness, rotational stiffness and damping; thresholds of force [N] and torque [N m]
  cobotQ: number[];  // [rad or m] joint positions; in m for a prismatic joint
  endEffector: Pose;  // [m] in W
  object: Pose;  // [m] in W
  movables: Pose[];  // [m] in W of the scenario's environment.objects, in their order
  qpRelaxed: boolean;  // a slack is above its tolerance
  qpFailed: boolean;  // no verified solution
  guardAltered: boolean;  // the guard changed the command
  relativeSlack: number[];  // [m/s, rad/s] slack of the relative-pose task
  linkDistance: number;  // [m] distance of the nearest link pair; inf without pairs and before the first QP
  stageUs: number[];  // [us] computing time of the stage (tick: of all)
  sentNs: number;  // [ns] monotonic clock when the server sent it
  recording: boolean;  // the run is recorded
}

export const kRunFields = {
  tick: ['tick', 'number', 'u64', 1],
  run_time: ['runTime', 'number', 'f64', 1],
  wall_ns: ['wallNs', 'number', 'u64', 1],
  state: ['state', 'state', 'u8', 1],
  cause: ['cause', 'cause', 'u8', 1],
  cause_hand: ['causeHand', 'number', 'i8', 1],
  action: ['action', 'number', 'i32', 1],
  cause_value: ['causeValue', 'number', 'f64', 1],
  cause_limit: ['causeLimit', 'number', 'f64', 1],
  cause_quantity: ['causeQuantity', 'quantity', 'u8', 1],
  events: ['events', 'number', 'u16', 1],
  latest_event: ['latestEvent', 'number', 'u8', 1],
  cobot_stop: ['cobotStop', 'number', 'u8', 1],
  attachment: ['attachment', 'number', 'u8', 1],
  harder_cause: ['harderCause', 'cause', 'u8', 1],
  harder_cause_hand: ['harderCauseHand', 'number', 'i8', 1],
  harder_cause_quantity: ['harderCauseQuantity', 'quantity', 'u8', 1],
  harder_cause_value: ['harderCauseValue', 'number', 'f64', 1],
  harder_cause_limit: ['harderCauseLimit', 'number', 'f64', 1],
  parameters: ['parameters', 'numbers', 'f32', 5],
  cobot_q: ['cobotQ', 'numbers', 'f32', 16],
  end_effector: ['endEffector', 'pose', 'f32', 7],
  object: ['object', 'pose', 'f32', 7],
  movables: ['movables', 'poses', 'f32', 56],
  qp_relaxed: ['qpRelaxed', 'flag', 'u8', 1],
  qp_failed: ['qpFailed', 'flag', 'u8', 1],
  guard_altered: ['guardAltered', 'flag', 'u8', 1],
  relative_slack: ['relativeSlack', 'numbers', 'f32', 6],
  link_distance: ['linkDistance', 'number', 'f64', 1],
  stage_us: ['stageUs', 'numbers', 'f32', 8],
  sent_ns: ['sentNs', 'number', 'u64', 1],
  recording: ['recording', 'flag', 'u8', 1],
} as const;

export interface HandQuantities {
  present: boolean;  // the arm exists
  gripping: boolean;  // simulated operator: grips; otherwise: the state is RUN
  armFault: boolean;  // the arm reports a fault
  real: Pose;  // [m] in W
  virtual: Pose;  // [m] in W
  wrench: number[];  // [N, N m] in W wrench of the hand on the handle, about H
  coupling: number[];  // [N, N m] in W wrench of the virtual coupling on D
  armQ: number[];  // [rad] joint positions of the arm, measured
  sensorAge: number;  // [s] age of the sensor's sample
  manipulability: number;  // translational manipulability of the arm
  peak: number[];  // [N, N m] largest force and torque since the previous state
  keepsPower: boolean;  // the arm reports power although it should have been cut
}

export const kHandFields = {
  present: ['present', 'flag', 'u8', 1],
  gripping: ['gripping', 'flag', 'u8', 1],
  arm_fault: ['armFault', 'flag', 'u8', 1],
  real: ['real', 'pose', 'f32', 7],
  virtual: ['virtual', 'pose', 'f32', 7],
  wrench: ['wrench', 'numbers', 'f32', 6],
  coupling: ['coupling', 'numbers', 'f32', 6],
  arm_q: ['armQ', 'numbers', 'f32', 10],
  sensor_age: ['sensorAge', 'number', 'f64', 1],
  manipulability: ['manipulability', 'number', 'f64', 1],
  peak: ['peak', 'numbers', 'f32', 2],
  keeps_power: ['keepsPower', 'flag', 'u8', 1],
} as const;
