// A made-up person for the fake server, with a body that reaches both handles and loads that
// change.
const kSides = ['left', 'right'];
// The lengths of the made-up body [m].
const kHip = 0.92, kTrunk = 0.53, kShoulder = 0.19, kUpper = 0.3, kFore = 0.34, kFoot = 0.2;

const add = (a, b, s = 1) => a.map((v, i) => v + s * b[i]);
const length = (a) => Math.hypot(...a);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

// Places the elbow between shoulder and hand, below the line between them.
function elbowOf(shoulder, hand) {
  const d = add(hand, shoulder, -1);
  const reach = Math.min(length(d), kUpper + kFore - 1e-3);
  const along = (kUpper ** 2 - kFore ** 2 + reach ** 2) / (2 * reach);
  const out = Math.sqrt(Math.max(kUpper ** 2 - along ** 2, 0));
  const axis = d.map((v) => v / length(d));
  const side = cross(axis, [0, 0, 1]);
  const down = cross(axis, side).map((v) => v / Math.max(length(side), 1e-6));
  return add(add(shoulder, axis, along), down, out);
}

// Returns the points of the body in W [m]. Each hand takes the handle on its side, of which
// `handles` gives the places. The trunk leans forward as far as needed.
export function pointsOf({ground, forward, feet}, handles) {
  const left = [-forward[1], forward[0], 0];
  const beside = (p) => p[0] * left[0] + p[1] * left[1];
  const [toRight, toLeft] = Object.values(handles).sort((a, b) => beside(a) - beside(b));
  const hands = {left: toLeft, right: toRight};
  const at = (ahead, beside, up) => add(add(add(ground, forward, ahead), left, beside), [0, 0, 1], up);
  const trunk = (lean) => {
    const up = (r, beside = 0) => at(r * Math.sin(lean), beside, kHip + r * Math.cos(lean));
    return {neck: up(kTrunk), head: up(kTrunk + 0.13), l5s1: up(0.1),
            eyes: add(up(kTrunk + 0.18), forward, 0.1),
            left_shoulder: up(kTrunk - 0.06, kShoulder), right_shoulder: up(kTrunk - 0.06, -kShoulder)};
  };
  const reaches = (upper) => kSides.every((side) =>
    length(add(hands[side], upper[`${side}_shoulder`], -1)) < kUpper + kFore - 0.06);
  let lean = 0.05;
  while (lean < 1.3 && !reaches(trunk(lean))) lean += 0.02;
  const points = {pelvis: at(0, 0, kHip), ...trunk(lean)};
  for (const [side, sign] of [['left', 1], ['right', -1]]) {
    points[`${side}_elbow`] = elbowOf(points[`${side}_shoulder`], hands[side]);
    points[`${side}_wrist`] = add(hands[side], add(points[`${side}_elbow`], hands[side], -1), 0.22);
    points[`${side}_hand`] = hands[side];
    points[`${side}_hip`] = at(0, 0.085 * sign, kHip);
    points[`${side}_knee`] = at(0.02, sign * (0.04 + feet / 4), 0.48);
    points[`${side}_ankle`] = at(0, (sign * feet) / 2, 0.07);
    points[`${side}_toes`] = at(kFoot, (sign * feet) / 2, 0.02);
  }
  return {points, lean};
}

function gauges(t, lean, wrenches) {
  const range = (value, spread) => ({value, low: value * (1 - spread), high: value * (1 + 1.3 * spread)});
  const use = (k) => range(0.3 + 0.25 * Math.sin(0.5 * t + k), 0.3);
  const alone = (value) => ({value, low: null, high: null});
  const measured = (side) => alone(Math.hypot(...wrenches[side].slice(0, 3)));
  return {
    lower_back_compression: range(900 + 1500 * lean + 500 * Math.sin(0.5 * t), 0.35),
    lower_back_shear: range(180 + 260 * lean, 0.25), lower_back_moment: range(30 + 80 * lean, 0.4),
    balance_margin: {value: 0.06, low: 0.01, high: 0.08},
    trunk_flexion: {value: lean, low: lean - 0.2, high: lean + 0.25},
    left_shoulder_use: use(0), right_shoulder_use: use(0.4), left_elbow_use: use(0.8), right_elbow_use: use(1.2),
    left_hand_force: measured('left'), right_hand_force: measured('right'),
    left_arm_activation: alone(0.3 + 0.2 * Math.sin(0.5 * t)), right_arm_activation: alone(0.25),
    left_hand_stiffness: alone(60), right_hand_stiffness: alone(75),
  };
}

// Returns the message `person` at the run time t [s]. `status` is 'judged', or the reason why
// nothing is judged. `head` is the origin of the head. `range` is the largest
// load of the lower back as a share of the range of LiFFT. `inputs` are the measurements of streams.
export function personMessage(spec, t, tick, hands, wrenches, status = 'judged', head = 'modelled', range = 0.4,
                              inputs = {}) {
  const judged = status === 'judged';
  const {points, lean} = pointsOf(spec.viewpoint, hands);
  const known = gauges(t, lean, wrenches);
  const nothing = (object) => Object.fromEntries(Object.entries(object).map(([name]) => [name, null]));
  const part = (load, capacity) => ({load: judged ? load : null, capacity, damage: 1e-7 * t, day_share: 3e-6 * t, load_over_range: null});
  const elbow = (load, capacity) => ({...part(load, capacity), damage: null, day_share: null});
  const score = (value, level, probability) =>
    (judged ? {score: value, level, probability} : {score: 0, level: 0, probability: null});
  const input = (name, [state, last] = inputs[name] ?? ['none', null]) => ({status: state, last});
  const warns = judged && known.left_shoulder_use.value > 0.5;
  return {
    type: 'person', tick, run_time: t, load_time: t - 0.1, interval_time: t - 0.2, since: 0, status,
    head: judged ? head : 'modelled', heart_rate: inputs.heart_rate ?? null,
    inputs: {left_elbow: input('left_elbow'), right_elbow: input('right_elbow'), left_emg: input('left_emg'), right_emg: input('right_emg'),
             heart_rate: inputs.heart_rate ? {status: 'measured', last: t} : {status: 'none', last: null}},
    reached: true, miss: 0, sampled_reached: 1, warnings: warns ? ['left_shoulder'] : [],
    points: judged ? points : nothing(points),
    parts: {
      lower_back: {...part(known.lower_back_compression.value / 3400, null), load_over_range: range},
      left_shoulder: part(known.left_shoulder_use.value, 0.97), right_shoulder: part(known.right_shoulder_use.value, 0.96),
      left_elbow: elbow(known.left_elbow_use.value, 0.99), right_elbow: elbow(known.right_elbow_use.value, 0.98),
    },
    gauges: judged ? known : Object.fromEntries(Object.entries(known).map(([name, gauge]) => [name, nothing(gauge)])),
    scores: {rula: score(4, 2, [0.1, 0.62, 0.24, 0.04]), reba: score(5, 3, [0, 0.3, 0.6, 0.1, 0]),
             owas: score(1, 1, [0.8, 0.2, 0, 0])},
  };
}
