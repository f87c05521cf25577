// Generated from src/core/person_state.h: build/release/bin/page_quantities person writes this file.

export interface PersonState {
  type: 'person';
  tick: number;  // the newest tick that is taken into account
  run_time: number | null;  // [s] time of the points: middle of the 10 ms that end with that tick
  load_time: number | null;  // [s] time of loads, scores and warnings
  interval_time: number | null;  // [s] time of intervals and probabilities
  since: number | null;  // [s] start of damage and fatigue
  status: 'judged' | 'waiting' | 'no_hand' | 'below_ground';  // whether the person is judged, or why not
  head: 'modelled' | 'measured' | 'impossible';  // origin of the head of the points; impossible: modelled despite a measurement
  heart_rate: number | null;  // [1/min] newest value that a stream measured
  inputs: Record<'left_elbow' | 'right_elbow' | 'left_emg' | 'right_emg' | 'heart_rate', {status: 'none' | 'measured' | 'missing' | 'impossible'; last: number | null}>;  // measurements of other systems
  reached: boolean;  // both hands reach their handles
  miss: number | null;  // [m] largest distance between a hand and its handle
  sampled_reached: number | null;  // share of the possible people who reach both
  warnings: ('lower_back_compression' | 'lower_back_shear' | 'balance' | 'left_shoulder' | 'right_shoulder' | 'left_elbow' | 'right_elbow' | 'rula' | 'reba' | 'owas' | 'reach')[];  // active warnings
  points: Record<'pelvis' | 'l5s1' | 'neck' | 'head' | 'eyes' | 'left_shoulder' | 'left_elbow' | 'left_wrist' | 'left_hand' | 'right_shoulder' | 'right_elbow' | 'right_wrist' | 'right_hand' | 'left_hip' | 'left_knee' | 'left_ankle' | 'left_toes' | 'right_hip' | 'right_knee' | 'right_ankle' | 'right_toes', [number, number, number] | null>;  // in W [m]
  parts: Record<'lower_back' | 'left_shoulder' | 'right_shoulder' | 'left_elbow' | 'right_elbow', Record<'load' | 'capacity' | 'damage' | 'day_share' | 'load_over_range', number | null>>;
  gauges: Record<'lower_back_compression' | 'lower_back_shear' | 'lower_back_moment' | 'balance_margin' | 'trunk_flexion' | 'left_shoulder_use' | 'right_shoulder_use' | 'left_elbow_use' | 'right_elbow_use' | 'left_hand_force' | 'right_hand_force' | 'left_arm_activation' | 'right_arm_activation' | 'left_hand_stiffness' | 'right_hand_stiffness', Record<'value' | 'low' | 'high', number | null>>;
  scores: Record<'rula' | 'reba' | 'owas', {score: number; level: number; probability: number[] | null}>;
}

export const kPersonGauges = {
  lower_back_compression: {unit: 'N', limit: 3400, lowIsBad: false, source: 'modelled', meaning: 'compression of the disc L5/S1; too uncertain for the limit, so only for comparisons'},
  lower_back_shear: {unit: 'N', limit: 700, lowIsBad: false, source: 'modelled', meaning: 'forward shear of L5/S1'},
  lower_back_moment: {unit: 'N m', limit: 0, lowIsBad: false, source: 'modelled', meaning: 'moment of the extensors of the back about L5/S1'},
  balance_margin: {unit: 'm', limit: 0, lowIsBad: true, source: 'modelled', meaning: 'distance from the centre of pressure to the edge of the feet; negative: outside'},
  trunk_flexion: {unit: 'rad', limit: 0, lowIsBad: false, source: 'modelled', meaning: 'angle of the torso to the vertical, forward'},
  left_shoulder_use: {unit: '', limit: 1, lowIsBad: false, source: 'modelled', meaning: 'torque divided by the mean strength of this sex, flexion'},
  right_shoulder_use: {unit: '', limit: 1, lowIsBad: false, source: 'modelled', meaning: 'torque divided by the mean strength of this sex, flexion'},
  left_elbow_use: {unit: '', limit: 1, lowIsBad: false, source: 'modelled', meaning: 'torque divided by the mean strength of this sex'},
  right_elbow_use: {unit: '', limit: 1, lowIsBad: false, source: 'modelled', meaning: 'torque divided by the mean strength of this sex'},
  left_hand_force: {unit: 'N', limit: 0, lowIsBad: false, source: 'measured', meaning: 'magnitude of the force on the handle'},
  right_hand_force: {unit: 'N', limit: 0, lowIsBad: false, source: 'measured', meaning: 'magnitude of the force on the handle'},
  left_arm_activation: {unit: '', limit: 0, lowIsBad: false, source: 'muscles', meaning: 'largest activation of a muscle'},
  right_arm_activation: {unit: '', limit: 0, lowIsBad: false, source: 'muscles', meaning: 'largest activation of a muscle'},
  left_hand_stiffness: {unit: 'N/m', limit: 0, lowIsBad: false, source: 'muscles', meaning: 'smallest principal stiffness; a lower bound'},
  right_hand_stiffness: {unit: 'N/m', limit: 0, lowIsBad: false, source: 'muscles', meaning: 'smallest principal stiffness; a lower bound'},
} as const;

export const kPersonScores = {
  rula: {most: 7, levels: 4},
  reba: {most: 15, levels: 5},
  owas: {most: 4, levels: 4},
} as const;

export const kPersonWarnings = {
  lower_back_compression: {words: 'The compression of the lower back is above 3400 N.'},
  lower_back_shear: {words: 'The shear of the lower back is above 700 N.'},
  balance: {words: 'The centre of pressure is outside the feet: this person must step or lean.'},
  left_shoulder: {words: 'The left shoulder needs more than half of the mean strength.'},
  right_shoulder: {words: 'The right shoulder needs more than half of the mean strength.'},
  left_elbow: {words: 'The left elbow needs more than half of the mean strength.'},
  right_elbow: {words: 'The right elbow needs more than half of the mean strength.'},
  rula: {words: 'RULA requires immediate changes.'},
  reba: {words: 'REBA requires immediate action.'},
  owas: {words: 'OWAS requires immediate changes.'},
  reach: {words: 'The body does not reach the handles.'},
} as const;
