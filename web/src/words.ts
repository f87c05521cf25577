// Provides states, causes of stops and advice as texts from the catalogue.
import {message, MessageId} from './messages';
import {kSides, Quantity, Reason, RunState, State} from './protocol';

export interface StateWords {
  title: string;
  meaning: string;
  tone: 'calm' | 'ready' | 'running' | 'warning' | 'stopped';
}

type Tone = StateWords['tone'];

const kTones: Record<RunState, Tone> = {
  INIT: 'calm', SELFTEST: 'warning', IDLE: 'calm', ALIGN: 'warning', ARMED: 'ready', RUN: 'running',
  STOPPING: 'stopped', HELD: 'stopped', UNPOWERED: 'stopped', RECOVERY: 'warning',
};

export function stateWords(state: State): StateWords {
  const name = state.state;
  const done = state.stop.cause === 'none' && !armAtFault(state);
  if (done && (name === 'STOPPING' || name === 'HELD')) {
    return {title: message(`state.done.${name}.title`), meaning: message(`state.done.${name}.meaning`), tone: 'calm'};
  }
  return {title: message(`state.${name}.title`), meaning: message(`state.${name}.meaning`), tone: kTones[name]};
}

// A problem between this page and the run, shown on the page and in the headset.
export interface Trouble {
  title: string;
  meaning: string;
  emergency: string;   // position of the stop button, or the text beside it
  mayStop: boolean;    // the stop button may still have an effect
  tone?: StateWords['tone'];  // tone of the state card; default: stopped
}

function trouble(name: 'closed' | 'silent' | 'ignored', mayStop: boolean): Trouble {
  return {
    title: message(`link.${name}.title`), meaning: message(`link.${name}.meaning`),
    emergency: message(`link.${name}.emergency`), mayStop,
  };
}

// When the run has ended, there is no problem, but there is also nothing to stop.
function atEnd(name: 'results' | 'ended'): Trouble {
  return {
    title: message(`link.${name}.title`), meaning: message(`link.${name}.meaning`),
    emergency: '', mayStop: false, tone: 'calm',
  };
}

export const kTroubles = {
  closed: trouble('closed', false),
  silent: trouble('silent', false),
  results: atEnd('results'),
  ended: atEnd('ended'),
  ignored: trouble('ignored', true),
};

// A simulated rig has no emergency stop.
const kSimulatedTroubles = {
  closed: onSimulatedArms(kTroubles.closed),
  silent: onSimulatedArms(kTroubles.silent),
  ignored: onSimulatedArms(kTroubles.ignored),
};

function onSimulatedArms(words: Trouble): Trouble {
  return {...words, emergency: message('link.simulated.emergency')};
}

// Returns the words for a lost connection, for a run that sends no states, or for a stop request
// without effect.
export function lossWords(name: keyof typeof kSimulatedTroubles, simulated: boolean): Trouble {
  return (simulated ? kSimulatedTroubles : kTroubles)[name];
}

export interface StopWords {
  cause: string;   // the fault, with hand, value and limit
  advice: string;  // recommended action
}

type StopId = MessageId extends infer Id ? Id extends `stop.${infer Name}.advice` ? Name : never : never;

// Returns the name of the stop in the catalogue. The measured quantity may describe the stop more
// precisely than the cause does.
function stopId({cause, quantity}: Reason): StopId | null {
  if (cause === 'none') return null;
  if (cause === 'stale' && quantity === 'arm_age') return 'arm_stale';
  if (cause === 'stale' && quantity === 'sensor_age') return 'sensor_stale';
  if (cause === 'stale' && quantity === 'count') return 'sensor_frozen';
  if (cause === 'oscillation' && quantity === 'vibration') return 'vibration';
  if (cause === 'sensor' && quantity !== 'none') return 'taring';
  if (cause === 'device' && quantity === 'angle') return 'angle_jump';
  if (cause === 'deadline' && quantity === 'time') return 'suspended';
  if (cause === 'physics' && quantity === 'count') return 'controller';
  if (cause === 'physics' && quantity === 'time') return 'controller_late';
  if (cause === 'physics' && quantity === 'allocations') return 'controller_allocates';
  if (cause === 'device' && (quantity === 'speed' || quantity === 'time')) return 'no_rest';
  return cause;
}

// Returns whether an arm reports a fault. An arm with a fault does not move until the program is
// restarted.
function armAtFault(state: State): boolean {
  return kSides.some((side) => state.hands[side].present && state.hands[side].armFault);
}

// Returns whether more than a reset is needed.
function needsANewStart(state: State): boolean {
  return armAtFault(state) || [state.stop, state.harder].some(({cause, quantity}) =>
    cause === 'device' || (cause === 'stale' && quantity === 'count'));
}

// Formats a value with this number of decimals. The result never has a minus sign before zero.
export function fixed(value: number, decimals: number): string {
  const text = value.toFixed(decimals);
  return /^-[0.]*$/.test(text) ? text.slice(1) : text;
}

// Formats a value in readable units, such as millimetres and degrees. `more` is the number of
// digits in addition to the usual ones.
export function readable(value: number, quantity: Quantity, more = 0): string {
  const degrees = (value * 180) / Math.PI;
  const d = 1 + more;
  switch (quantity) {
    case 'none': case 'not_finite': return '';
    case 'count': case 'allocations': return value.toFixed(0);
    case 'force': case 'vibration': return `${value.toFixed(d)} N`;
    case 'torque': return `${value.toFixed(d + 1)} N·m`;
    case 'length': return `${(value * 1000).toFixed(d)} mm`;
    case 'angle': return `${degrees.toFixed(d)}°`;
    case 'speed': return `${(value * 1000).toFixed(d)} mm/s`;
    case 'angular_speed': return `${degrees.toFixed(d)}°/s`;
    case 'acceleration': return `${value.toFixed(more)} m/s²`;
    case 'angular_acceleration': return `${value.toFixed(more)} rad/s²`;
    case 'time': return value >= 10 ? `${value.toFixed(d)} s` : `${(value * 1000).toFixed(d)} ms`;
    case 'arm_age': case 'sensor_age': return `${(value * 1000).toFixed(d)} ms`;
  }
}

// Formats a value with enough digits to distinguish it from the limit that it exceeded.
function beyond(value: number, limit: number, quantity: Quantity): string {
  const words = (more: number) => [value, limit].map((it) => readable(it, quantity, more));
  let [is, may] = words(0);
  for (let more = 1; more <= 3 && is === may; more++) [is, may] = words(more);
  return message('value', {value: is, limit: may});
}

// Describes the measured quantity, like MeasuredWords in the program.
function measured({cause, value, limit, quantity}: Reason): string {
  if (quantity === 'none') return '';
  if (quantity === 'not_finite') return message('value.not_finite');
  const numbers = beyond(value, limit, quantity);
  if (cause !== 'physics') return numbers;
  switch (quantity) {
    case 'count': return message('value.torques', {count: fixed(value, 0)});
    case 'allocations': return message('value.allocations', {count: fixed(value, 0)});
    case 'time': return message('value.silence', {value: numbers});
    case 'acceleration': case 'angular_acceleration': return message('value.acceleration', {value: numbers});
    default: return message('value.speed', {value: numbers});
  }
}

function capital(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

// Describes the fault by its kind, its place and its amount.
function sentence(why: Reason): string {
  const id = stopId(why);
  const text = id ? message(`stop.${id}.cause`) : '';
  const amount = measured(why);
  const numbers = amount ? ` (${amount})` : '';
  return (why.hand ? message(`hand.${why.hand}`, {text}) : capital(text)) + numbers + '.';
}

function advice(why: Reason): string {
  const id = stopId(why);
  return id ? message(`stop.${id}.advice`) : '';
}

// Returns null unless a stop occurred. If `over` is true, the run has ended and there is nothing to
// reset.
export function stopWords(state: State, simulated: boolean, over = false): StopWords | null {
  if (state.stop.cause === 'none') return null;
  // A reset is not enough if the power is off or the program must be restarted.
  const next = over ? message('next.run_again') :
      state.state === 'UNPOWERED' && !simulated ? message('next.console') :
      needsANewStart(state) ? message('next.restart') : message('next.reset');
  const because = state.harder.cause === 'none' ? '' :
    ' ' + message('stop.power_off_because', {cause: sentence(state.harder)});
  // A device fault may follow the stop without changing its cause.
  const fault = armAtFault(state) ? message('stop.device.advice') : '';
  const steps = [...new Set([advice(state.stop), advice(state.harder), fault])].filter((it) => it);
  return {cause: sentence(state.stop) + because, advice: [...steps, next].join(' ')};
}

// Returns the console's text about arms that should be without power but are not, or '' if there
// are no such arms.
function powerWords(state: State): string {
  const kept = kSides.filter((side) => state.hands[side].present && state.hands[side].keepsPower);
  if (kept.length === 0) return '';
  return kept.length > 1 ? message('danger.both_keep_power') :
      message('danger.keeps_power', {SIDE: kept[0].toUpperCase()});
}

const kFreeForce = 5;  // a handle with a larger force is not free [N]

// Returns the remaining danger after a stop, if there is one. The function returns only the worst
// danger. The danger after an emergency stop is regarded as the worst.
export function dangerWords(state: State, simulated: boolean): string {
  return powerWords(state) || loadedWords(state, simulated);
}

// Returns the text about hands on which real arms still press after a stop, or '' if there are no
// such hands.
function loadedWords(state: State, simulated: boolean): string {
  if (simulated || (state.state !== 'HELD' && state.state !== 'UNPOWERED')) return '';
  const loaded = kSides.flatMap((side) => {
    const {present, wrench} = state.hands[side];
    const force = Math.hypot(wrench[0], wrench[1], wrench[2]);
    return present && force > kFreeForce ? [`${side} handle, ${force.toFixed(0)} N`] : [];
  });
  if (loaded.length === 0) return '';
  const caught = state.state === 'HELD' && !armAtFault(state) ?
      message('danger.caught_recover_page') : message('danger.caught_free');
  return message('danger.loaded_page', {handles: loaded.join('; '), caught});
}

// Returns the texts for a run that has ended.
export function overWords(state: State | null, how: string): StateWords {
  const stopped = state !== null && (state.stop.cause !== 'none' || armAtFault(state));
  return stopped ? {title: message('state.over.stopped.title'), meaning: how, tone: 'stopped'} :
                   {title: message('state.over.finished.title'), meaning: how, tone: 'ready'};
}

export const kParameterWords = {
  stiffness_translation: {label: 'Stiffness, transl.', unit: '×', digits: 2},
  stiffness_rotation: {label: 'Stiffness, rot.', unit: '×', digits: 2},
  damping_ratio: {label: 'Damping ratio', unit: '×', digits: 2},
  force: {label: 'Force threshold', unit: 'N', digits: 1},
  torque: {label: 'Torque threshold', unit: 'N·m', digits: 1},
} as const;

// The level that shows how close a wrench is to its threshold.
export type Level = 'green' | 'orange' | 'red';

// Returns green below 50 % of the threshold, orange up to 80 %, and red above 80 %, so that red
// appears before the stop.
export function level(value: number, threshold: number): Level {
  const ratio = value / threshold;
  return ratio < 0.5 ? 'green' : ratio <= 0.8 ? 'orange' : 'red';
}
export const kWarningLevel = 0.8;

const kGripWords = ['holds the object', 'slips', 'is open', 'is open: the object was too far away to be grasped'];

// Describes the cobot's grip on the object.
export function gripWords(state: State): string {
  const words = kGripWords[state.attachment];
  return words === undefined ? '' : `The gripper ${words}.`;
}

// Describes the effect of the last event in `acting`, which is the one that began last. Also
// describes whether the virtual cobot has stopped itself.
export function hazardWords(state: State, acting: string[]): string {
  const meaning = acting.at(-1);
  const words = meaning === undefined ? [] : [`Event: ${meaning}.`];
  if (state.cobotStop > 0) words.push('The cobot has stopped itself.');
  return words.join(' ');
}
