// Shows the states of the person over time. The body moves smoothly between the states. All other
// data come from the newest state.
import {kSides, PersonState, Side, Vec3} from './protocol';

export type BodyPoints = {[K in keyof PersonState['points']]: Vec3};

const kKept = 12;
const kLargestGapMs = 400;  // states with a larger gap are not interpolated
const kSilentMs = 1500;     // a judged person without news for longer is no longer shown as judged

interface Entry {
  points: BodyPoints;
  receivedMs: number;
}

export class PersonPlayer {
  latest: PersonState | null = null;
  count = 0;  // number of messages
  private receivedMs = -Infinity;
  private entries: Entry[] = [];

  reset() {
    this.latest = null;
    this.entries = [];
  }

  add(person: PersonState, receivedMs: number) {
    this.latest = person;
    this.receivedMs = receivedMs;
    this.count++;
    const points = pointsOf(person);
    if (points) {
      const last = this.entries.at(-1);
      if (last && receivedMs - last.receivedMs > kLargestGapMs) this.entries = [];
      this.entries.push({points, receivedMs});
      if (this.entries.length > kKept) this.entries.shift();
    } else if (person.status !== 'waiting') {
      this.entries = [];
    }
  }

  // Returns whether the evaluator judges the person but has sent nothing for too long.
  silent(nowMs: number): boolean {
    return this.latest?.status === 'judged' && nowMs - this.receivedMs > kSilentMs;
  }

  // Returns the body at the page's time `nowMs`, with a delay of about one message, or null if the
  // body is not known. While no simulated time passes, the body does not move.
  sample(nowMs: number): BodyPoints | null {
    const n = this.entries.length;
    if (n === 0) return null;
    const first = this.entries[0].receivedMs;
    const interval = n > 1 ? (this.entries[n - 1].receivedMs - first) / (n - 1) : 0;
    const playMs = nowMs - 1.5 * interval;
    const after = this.entries.findIndex((entry) => entry.receivedMs > playMs);
    if (after < 0) return this.entries[n - 1].points;
    if (after === 0) return this.entries[0].points;
    const [a, b] = [this.entries[after - 1], this.entries[after]];
    return mixPoints(a.points, b.points, (playMs - a.receivedMs) / (b.receivedMs - a.receivedMs));
  }
}

// Returns null if a point is not known.
function pointsOf(person: PersonState): BodyPoints | null {
  return Object.values(person.points).every((point) => point !== null) ? person.points as BodyPoints : null;
}

function mixPoints(a: BodyPoints, b: BodyPoints, t: number): BodyPoints {
  return Object.fromEntries(Object.entries(a).map(([name, from]) => {
    const to = b[name as keyof BodyPoints];
    return [name, from.map((x, i) => x + (to[i] - x) * t)];
  })) as BodyPoints;
}

// The place, the directions and the size of the figure of the body in a mirror. Directions are
// horizontal unit vectors.
export interface MirrorPlace {
  at: Vec3;        // position of the figure's feet
  toward: Vec3;    // direction from the person to the mirror
  scale: number;
}

// Returns the mirror image of the body of a person who stands at `ground` and faces `forward`. The
// figure faces the person, with its left side on the person's left.
export function mirrored(points: BodyPoints, ground: Vec3, forward: Vec3, {at, toward, scale}: MirrorPlace): BodyPoints {
  return Object.fromEntries(Object.entries(points).map(([name, p]) => {
    const [x, y, up] = p.map((v, i) => scale * (v - ground[i]));
    const ahead = x * forward[0] + y * forward[1];
    const left = y * forward[0] - x * forward[1];
    return [name, [at[0] - ahead * toward[0] - left * toward[1], at[1] - ahead * toward[1] + left * toward[0],
                   at[2] + up]];
  })) as BodyPoints;
}

export const kWhyNot: Record<Exclude<PersonState['status'], 'judged'>, string> = {
  waiting: 'No simulated time passes.',
  no_hand: 'No hand holds a handle, so the posture is not known.',
  below_ground: 'The handles are below the ground: correct operator.stance.ground.',
};

// Describes the origin of the head of the drawn body. An older server does not send this origin.
export const kHeadWords: Record<PersonState['head'], string> = {
  measured: 'The head is measured.',
  modelled: 'The head is modelled.',
  impossible: 'The head is modelled, because it is measured where this person’s head cannot be: ' +
      'register again, or correct operator.stance.',
};

const kInputWords: Record<keyof PersonState['inputs'], string> = {
  left_elbow: 'left elbow', right_elbow: 'right elbow', left_emg: 'EMG of the left arm', right_emg: 'EMG of the right arm',
  heart_rate: 'heart rate',
};

// Describes what streams of other systems measure, and what is missing since when. Returns an empty
// list if the run has no streams. An older server does not send the inputs.
export function inputLines({inputs, heart_rate: rate}: PersonState): {text: string; bad: boolean}[] {
  return Object.entries(inputs ?? {}).flatMap(([name, {status, last}]): {text: string; bad: boolean}[] => {
    if (status === 'none') return [];
    const words = kInputWords[name as keyof PersonState['inputs']];
    const what = words[0].toUpperCase() + words.slice(1);
    if (status === 'measured')
      return [{text: `${what}: measured${name === 'heart_rate' && rate !== null ? `, ${rate.toFixed(0)} per minute` : ''}.`, bad: false}];
    const since = last === null ? 'since the start' : `since ${last.toFixed(1)} s`;
    return [{text: status === 'missing' ? `${what}: missing ${since}.` :
        `${what}: not used ${since}, because it is measured where it cannot be. Check the frame of its mapping.`, bad: true}];
  });
}

// Lists the damage and fatigue of the shoulders and elbows of both sides, under the names of the
// parts in the state.
export const kArmParts = kSides.flatMap((side: Side) => [`${side}_shoulder`, `${side}_elbow`] as const);
