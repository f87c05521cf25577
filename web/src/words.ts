// The run in plain words: states, causes of stops and what to do about them.
import {kSides, Quantity, Reason, RunState, Side, State, StopCause} from './protocol';

export interface StateWords {
  title: string;
  meaning: string;
  tone: 'calm' | 'ready' | 'running' | 'warning' | 'stopped';
}

const kStates: Record<RunState, StateWords> = {
  INIT: {title: 'Starting', meaning: 'The device has not answered yet.', tone: 'calm'},
  SELFTEST: {
    title: 'Self-test', meaning: 'Hands off: the sensors are being tared.', tone: 'warning',
  },
  IDLE: {title: 'Idle', meaning: 'All is well. Align the handles to begin.', tone: 'calm'},
  ALIGN: {
    title: 'Aligning', meaning: 'Hands off: the arms move slowly to the virtual handles.',
    tone: 'warning',
  },
  ARMED: {title: 'Armed', meaning: 'The handles are in place. Ready to start.', tone: 'ready'},
  RUN: {title: 'Running', meaning: 'The emulation runs.', tone: 'running'},
  STOPPING: {title: 'Stopping', meaning: 'Both arms brake.', tone: 'stopped'},
  HELD: {title: 'Stopped, held', meaning: 'The arms rest, powered.', tone: 'stopped'},
  UNPOWERED: {
    title: 'Stopped, power off',
    meaning: 'Power off was asked for. Not every robot obeys it: look at the robots’ own lights.',
    tone: 'stopped',
  },
  RECOVERY: {
    title: 'Recovery', meaning: 'The arm jogs slowly while the button is held.', tone: 'warning',
  },
};

// Of a run that came to its end, or was ended: nothing stopped it.
const kDone: Partial<Record<RunState, StateWords>> = {
  STOPPING: {title: 'Ending', meaning: 'The run is done: both arms brake.', tone: 'calm'},
  HELD: {title: 'Done, held', meaning: 'The run is done. The arms rest, powered.', tone: 'calm'},
};

export function stateWords(state: State): StateWords {
  const done = state.stop.cause === 'none' && !armAtFault(state);
  return (done && kDone[state.state]) || kStates[state.state];
}

// What is wrong between this page and the run, if anything: told on the page and in the headset.
export interface Trouble {
  title: string;
  meaning: string;
  emergency: string;   // where the stop button is, or beside it
  mayStop: boolean;    // the stop button may still help
}

export const kTroubles = {
  closed: {
    title: 'Not connected', meaning: 'What is shown is not the present.',
    emergency: 'Use the robot’s emergency stop', mayStop: false,
  },
  silent: {
    title: 'The run is silent', meaning: 'What is shown is not the present.',
    emergency: 'Use the robot’s emergency stop', mayStop: false,
  },
  ended: {
    title: 'Ended', meaning: 'What is shown is the last state. Start the program again, and open the ' +
        'address that it prints.',
    emergency: 'This run has ended: no button here does anything', mayStop: false,
  },
  ignored: {
    title: 'Not stopped', meaning: 'A stop was asked for, and the run goes on.',
    emergency: 'Not stopped: use the robot’s emergency stop', mayStop: true,
  },
} as const satisfies Record<string, Trouble>;

export interface StopWords {
  cause: string;   // what was wrong, with hand, value and limit
  advice: string;  // what to do
}

interface CauseWords {
  what: string;
  advice: string;  // before the reset
}

const kCauses: Record<Exclude<StopCause, 'none'>, CauseWords> = {
  force: {
    what: 'the force was above its threshold',
    advice: 'Guide the handles more gently',
  },
  torque: {
    what: 'the torque was above its threshold',
    advice: 'Twist the handles less',
  },
  sensor: {
    what: 'the force sensor gave a reading that cannot be trusted',
    advice: 'Check the sensor and its cable',
  },
  stale: {
    what: 'no fresh sample came in time',
    advice: 'Check network and cables of arm and sensor',
  },
  tracking: {
    what: 'the real handle was too far from the virtual one',
    advice: 'Move more slowly, or place the arms nearer to the task',
  },
  coupling: {
    what: 'the coupling of the real and the virtual handle pulled too hard',
    advice: 'The arms could not follow: move more slowly or stay within their reach',
  },
  elbow: {
    what: 'two links came nearer than their security distance',
    advice: 'Keep the handles further apart, or the arms’ bases',
  },
  joint: {
    what: 'a joint was beyond its limit',
    advice: 'Bring the arm back within its limits (recovery)',
  },
  oscillation: {
    what: 'the force oscillated more and more',
    advice: 'Hold the handles less stiffly, or lower the stiffness',
  },
  qp: {
    what: 'no motion was found that keeps all limits',
    advice: 'Start from a pose further from the limits',
  },
  physics: {
    what: 'the simulation diverged',
    advice: 'Lower the stiffness or check the scenario’s masses',
  },
  deadline: {
    what: 'ticks came too late',
    advice: 'Close other programs on this computer',
  },
  device: {
    what: 'the device reported a fault',
    advice: 'Look at the robot’s own panel and clear the fault there',
  },
  operator: {what: 'a person asked to stop', advice: 'Make sure that everybody is ready'},
  headset: {
    what: 'the headset was left or showed no new picture, so its wearer could not see the arms move',
    advice: 'Take the headset off or bring its picture back',
  },
  enabling: {
    what: 'the enabling key or device was let go',
    advice: 'Make sure that everybody is ready',
  },
  runaway: {
    what: 'the handle ran away against the hand that held it',
    advice: 'The sensor may read another way than it is pushed: test the pushes',
  },
};

// What is known more closely by what was measured.
const kCloser: Record<'armOld' | 'sensorOld' | 'frozen' | 'unsteady' | 'jump' | 'restless', CauseWords> = {
  armOld: {
    what: 'no fresh sample of the arm came in time',
    advice: 'Check the arm, its cable and its network',
  },
  sensorOld: {
    what: 'no fresh reading of the force sensor came in time',
    advice: 'Check the force sensor, its cable and its network',
  },
  frozen: {
    what: 'the force sensor repeated one and the same reading',
    advice: 'Look at the force sensor, and restart what repeats itself',
  },
  unsteady: {
    what: 'the force sensor did not read steadily while it was tared',
    advice: 'Keep hands off the handle until IDLE; where nobody touched it, check the sensor and its cable',
  },
  jump: {
    what: 'a joint’s angle jumped',
    advice: 'An encoder’s reading jumped: do not trust this arm until its own checks pass',
  },
  restless: {
    what: 'an arm did not come to rest though it was told to',
    advice: 'Do not trust this arm until its own checks pass',
  },
};

const kNothing: CauseWords = {what: '', advice: ''};

function causeWords({cause, quantity}: Reason): CauseWords {
  if (cause === 'none') return kNothing;
  if (cause === 'stale' && quantity === 'arm_age') return kCloser.armOld;
  if (cause === 'stale' && quantity === 'sensor_age') return kCloser.sensorOld;
  if (cause === 'stale' && quantity === 'count') return kCloser.frozen;
  if (cause === 'sensor' && quantity !== 'none') return kCloser.unsteady;
  if (cause === 'device' && quantity === 'angle') return kCloser.jump;
  if (cause === 'device' && (quantity === 'speed' || quantity === 'time')) return kCloser.restless;
  return kCauses[cause];
}

// An arm reports a fault: nothing moves it until the program is started again.
function armAtFault(state: State): boolean {
  return kSides.some((side) => state.hands[side].present && state.hands[side].armFault);
}

// After these a reset does not do.
function needsANewStart(state: State): boolean {
  return armAtFault(state) || [state.stop, state.harder].some(({cause, quantity}) =>
    cause === 'device' || (cause === 'stale' && quantity === 'count'));
}

// With so many decimals; no minus before nothing.
export function fixed(value: number, decimals: number): string {
  const text = value.toFixed(decimals);
  return /^-[0.]*$/.test(text) ? text.slice(1) : text;
}

// A value in readable units: millimetres and degrees for people. more: digits beyond the usual.
export function readable(value: number, quantity: Quantity, more = 0): string {
  const degrees = (value * 180) / Math.PI;
  const d = 1 + more;
  switch (quantity) {
    case 'none': return '';
    case 'count': return value.toFixed(0);
    case 'force': return `${value.toFixed(d)} N`;
    case 'torque': return `${value.toFixed(d + 1)} N·m`;
    case 'length': return `${(value * 1000).toFixed(d)} mm`;
    case 'angle': return `${degrees.toFixed(d)}°`;
    case 'speed': return `${(value * 1000).toFixed(d)} mm/s`;
    case 'angular_speed': return `${degrees.toFixed(d)}°/s`;
    case 'time': case 'arm_age': case 'sensor_age': return `${(value * 1000).toFixed(d)} ms`;
  }
}

// With digits enough to tell a value from the limit that it passed.
function beyond(value: number, limit: number, quantity: Quantity): string {
  const words = (more: number) => [value, limit].map((it) => readable(it, quantity, more));
  let [is, may] = words(0);
  for (let more = 1; more <= 3 && is === may; more++) [is, may] = words(more);
  return `${is}, limit ${may}`;
}

function capital(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

export function sideWords(side: Side): string {
  return side === 'left' ? 'Left hand' : 'Right hand';
}

// What is wrong, where, by how much.
function sentence(why: Reason): string {
  const {what} = causeWords(why);
  const numbers = why.quantity === 'none' ? '' : ` (${beyond(why.value, why.limit, why.quantity)})`;
  return (why.hand ? `${sideWords(why.hand)}: ${what}` : capital(what)) + numbers + '.';
}

// Null while nothing is stopped.
export function stopWords(state: State, simulated: boolean): StopWords | null {
  if (state.stop.cause === 'none') return null;
  // Where power is off, or the program is to be started again, a reset alone does not do.
  const next = state.state === 'UNPOWERED' && !simulated ?
      '. How to go on is told at the console.' :
      needsANewStart(state) ? ', then start the program again.' : ', then reset.';
  const harder = state.harder.cause === 'none' ? '' :
    ` Power off was asked for because of this: ${sentence(state.harder)}`;
  // An arm's fault may come behind the cause, and not change it.
  const words = [causeWords(state.stop), causeWords(state.harder),
                 armAtFault(state) ? kCauses.device : kNothing];
  const advice = [...new Set(words.map((it) => it.advice))].filter((it) => it).join('. ');
  return {cause: sentence(state.stop) + harder, advice: advice + next};
}

// Of arms that were to be without power and are not: as the console says it. '' if there are none.
function powerWords(state: State): string {
  const kept = kSides.filter((side) => state.hands[side].present && state.hands[side].keepsPower);
  if (kept.length === 0) return '';
  const who = kept.length > 1 ? 'BOTH ARMS STILL HAVE THEIR POWER' :
      `THE ${kept[0].toUpperCase()} ARM STILL HAS ITS POWER`;
  return `${who}, though it was to be cut. PRESS THE EMERGENCY STOP.`;
}

const kFreeForce = 5;  // a handle that is pressed with more is not free [N]

// What is still dangerous after a stop, if anything. The worst alone: the emergency stop comes first.
export function dangerWords(state: State, simulated: boolean): string {
  return powerWords(state) || loadedWords(state, simulated);
}

// Of hands that real arms still press on after a stop; '' if there are none.
function loadedWords(state: State, simulated: boolean): string {
  if (simulated || (state.state !== 'HELD' && state.state !== 'UNPOWERED')) return '';
  const loaded = kSides.flatMap((side) => {
    const {present, wrench} = state.hands[side];
    const force = Math.hypot(wrench[0], wrench[1], wrench[2]);
    return present && force > kFreeForce ? [`${side} handle, ${force.toFixed(0)} N`] : [];
  });
  if (loaded.length === 0) return '';
  const caught = state.state === 'HELD' && !armAtFault(state) ?
      'if one is caught, hold r at the console (with an enabling device: hold that, touch r)' :
      'if one is caught, free it by the robot’s own means (free-drive or brake release)';
  return `A hand is still loaded: ${loaded.join('; ')}. Let go; ${caught}.`;
}

export const kParameterWords = {
  stiffness_translation: {label: 'Stiffness, transl.', unit: '×', digits: 2},
  stiffness_rotation: {label: 'Stiffness, rot.', unit: '×', digits: 2},
  damping_ratio: {label: 'Damping ratio', unit: '×', digits: 2},
  force: {label: 'Force threshold', unit: 'N', digits: 1},
  torque: {label: 'Torque threshold', unit: 'N·m', digits: 1},
} as const;

// How near a wrench is to its threshold.
export type Level = 'green' | 'orange' | 'red';

// Green below 50 % of the threshold, orange to 80 %, red above: red is seen before the stop.
export function level(value: number, threshold: number): Level {
  const ratio = value / threshold;
  return ratio < 0.5 ? 'green' : ratio <= 0.8 ? 'orange' : 'red';
}
export const kWarningLevel = 0.8;
