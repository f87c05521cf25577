// Performs the registration with the person in the headset, who touches known points or places the
// controllers on the handles. After the registration, this class monitors whether the registration
// is still valid.
import {kSides, SceneSpec, scenarioOf, Side, State, Vec3} from '../protocol';
import {distance, matrix, vector} from '../scene/frames';
import {fit, load, PointPair, Registration, store, toWorld} from './registration';

const kMountMs = 4000;     // time for placing the controllers on the handles
const kMeasureMs = 500;    // last part of that time, over which poses are averaged
const kLongestFrameMs = 250;  // longest frame that counts, because the person sees the countdown
const kWorstResidual = 0.03;  // largest residual of correctly touched points [m]
const kDriftLimit = 0.03;  // [m]
const kDriftMs = 500;      // duration before it is reported
const kCheckLimit = 0.03;  // distance between a touch and the handle that confirms the registration [m]
const kCheckReach = 0.25;  // beyond this distance, the trigger had another purpose [m]
const kHandReach = 0.2;    // distance of a hand from the handle that it holds, however it holds it [m]

const kHandleColors: Record<Side, string> = {left: 'blue', right: 'violet'};

interface Point {
  words: string;
  known(state: State): Vec3;
}

// The position of a controller, in the headset's space (Z up) and in W.
export interface Place {
  space: Vec3;
  world: Vec3;
}
export type Controllers = Partial<Record<Side, Place>>;

// A controller or hand that moves with a handle, because the controller lies on the handle or the
// hand holds it.
interface Attached {
  handle: Side;
  offset: Vec3;        // position of the controller in the handle's frame [m]
  driftSinceMs: number;
}

export class Registrar {
  registration: Registration | null = null;
  drift = NaN;          // largest of the attached controllers [m]
  prompt = '';
  recentred = false;    // set by the headset's menu; invalidates the registration
  private touching: {points: Point[]; pairs: PointPair[]} | null = null;
  private mounting: {leftMs: number; samples: Record<Side, Vec3[]>} | null = null;
  private lastMs = 0;
  private readonly attached = new Map<Side, Attached>();  // by the controller's side
  private pending = false;  // offsets are measured in the first frame of the new registration
  private driftAlarm = false;
  private unchecked = false;  // made in an earlier session, whose space may have had a different origin
  private readonly held = new Map<Side, Attached & {by: Side}>();  // by the handle's side

  constructor(private readonly changed: (registration: Registration) => void) {}

  begin(spec: SceneSpec) {
    this.registration = load(scenarioOf(spec));
    this.recentred = false;
    this.unchecked = this.registration !== null;
    this.attached.clear();
    this.held.clear();
    this.cancel('');
  }

  // This function is called when the person has touched a point at `tip` in W. Near a handle, the
  // touch shows whether the registration of an earlier session is still valid.
  check(tip: Vec3, state: State) {
    if (!this.unchecked) return;
    const off = Math.min(...kSides.filter((side) => state.hands[side].present)
                             .map((side) => distance(tip, state.hands[side].real.p)));
    if (off > kCheckReach) return;
    this.unchecked = off > kCheckLimit;
    const words = `${(1000 * off).toFixed(0)} mm`;
    this.prompt = this.unchecked ? `${words} from the handle. Touch it again, or register again.` :
                                   `Checked: ${words} off.`;
  }

  get checked(): boolean {
    return this.registration !== null && !this.unchecked && !this.recentred;
  }

  // Returns whether the pose of the head in W can be trusted.
  get valid(): boolean {
    return this.checked && !this.driftAlarm;
  }

  get waitsForTouch(): boolean {
    return this.touching !== null;
  }

  get controllersAttached(): boolean {
    return this.attached.size > 0;
  }

  // Begins or cancels the registration in which the person touches points.
  toggleTouching(spec: SceneSpec, state: State) {
    if (this.touching) return this.cancel('Registration cancelled.');
    this.cancel('');
    const points: Point[] = kSides.filter((side) => state.hands[side].present).map((side) => ({
      words: `the ${side} handle (${kHandleColors[side]})`, known: (s) => s.hands[side].real.p,
    }));
    points.push({words: 'the centre of the cobot’s base', known: () => spec.cobot.base.p});
    this.touching = {points, pairs: []};
    this.askForPoint();
  }

  // This function is called when the person has touched a point. The point is given in the
  // headset's space with Z up.
  touch(touched: Vec3, spec: SceneSpec, state: State) {
    if (!this.touching) return;
    const {points, pairs} = this.touching;
    pairs.push({touched, known: points[pairs.length].known(state)});
    if (pairs.length < points.length) return this.askForPoint();
    this.touching = null;
    this.finish(pairs, spec);
  }

  // Begins or cancels the registration with controllers on the handles.
  toggleMounting() {
    if (this.mounting) return this.cancel('Registration cancelled.');
    this.cancel('');
    this.mounting = {leftMs: kMountMs, samples: {left: [], right: []}};
  }

  // Call this function in each frame with the head's position in the headset's space (Z up).
  update(nowMs: number, controllers: Controllers, head: Vec3, spec: SceneSpec, state: State) {
    this.drift = NaN;
    this.driftAlarm = false;
    this.watch(nowMs, controllers, state);
    if (!spec.simulated && this.checked) this.watchHeld(nowMs, controllers, state);
    const dtMs = Math.min(nowMs - this.lastMs, kLongestFrameMs);
    this.lastMs = nowMs;
    if (this.mounting) this.mount(dtMs, controllers, head, spec, state);
  }

  get alarm(): string {
    if (this.recentred) return 'The headset was re-centred. Register again.';
    if (this.unchecked) {
      return 'The registration of an earlier session is not checked. Touch a handle and pull the trigger ' +
          '(or pinch).';
    }
    return this.driftAlarm ?
      `Registration is off by ${(1000 * this.drift).toFixed(0)} mm. Register again.` : '';
  }

  private askForPoint() {
    const {points, pairs} = this.touching!;
    this.prompt = `${pairs.length + 1} of ${points.length}: touch ${points[pairs.length].words} ` +
        'and pull the trigger (or pinch).';
  }

  private cancel(prompt: string) {
    this.touching = null;
    this.mounting = null;
    this.prompt = prompt;
  }

  private finish(pairs: PointPair[], spec: SceneSpec) {
    try {
      this.adopt(fit(pairs), spec);
    } catch (error) {
      this.prompt = `Not registered. ${(error as Error).message}`;
    }
  }

  private adopt(registration: Registration, spec: SceneSpec) {
    const residual = `${(1000 * registration.residual).toFixed(1)} mm`;
    if (registration.residual > kWorstResidual) {
      this.prompt = `Not registered. The points are inconsistent (${residual}). Try again.`;
      return;
    }
    this.registration = registration;
    store(scenarioOf(spec), registration);
    this.recentred = false;
    this.unchecked = false;
    this.attached.clear();
    this.held.clear();
    this.drift = NaN;
    this.prompt = `Registered. Residual ${residual}.`;
    this.changed(registration);
  }

  private mount(dtMs: number, controllers: Controllers, head: Vec3, spec: SceneSpec,
                state: State) {
    const {samples} = this.mounting!;
    const leftMs = (this.mounting!.leftMs -= dtMs);
    this.prompt = 'Put a controller on each handle: ' +
        `measured in ${Math.max(leftMs / 1000, 0).toFixed(0)} s.`;
    if (leftMs < kMeasureMs) {
      kSides.forEach((side) => controllers[side] && samples[side].push(controllers[side]!.space));
    }
    if (leftMs > 0) return;
    this.mounting = null;
    const measured = kSides.filter((side) => samples[side].length > 0);
    const handles = kSides.filter((side) => state.hands[side].present);
    if (measured.length < 2 || handles.length < 2) {
      this.prompt = 'Not registered. This needs two controllers and two handles. Touch points instead.';
      return;
    }
    this.attach(measured.map((side) => mean(samples[side])), head, spec, state);
  }

  // Determines which controller is on which handle. The person is assumed to stand opposite the
  // cobot.
  private attach(touched: Vec3[], head: Vec3, spec: SceneSpec, state: State) {
    const fits = [kSides, [...kSides].reverse()].map((handles) => ({
      handles,
      registration: tryFit(touched.map((p, i) => ({
        touched: p, known: state.hands[handles[i]].real.p,
      }))),
    }));
    const [best] = fits.filter((f) => f.registration !== null)
                       .map((f) => ({...f, away: distance(
                           toWorld(head, f.registration!), spec.cobot.base.p)}))
                       .sort((a, b) => b.away - a.away);
    if (!best) {
      this.prompt = 'Not registered. The controllers are too close together.';
      return;
    }
    this.adopt(best.registration!, spec);
    if (this.registration !== best.registration) return;
    kSides.forEach((side, i) => this.attached.set(
        side, {handle: best.handles[i], offset: [0, 0, 0], driftSinceMs: NaN}));
    this.pending = true;
  }

  private watch(nowMs: number, controllers: Controllers, state: State) {
    for (const [side, attached] of this.attached) {
      const controller = controllers[side];
      if (!controller) continue;
      if (this.pending) attached.offset = inHandle(controller, attached.handle, state);
      this.compare(nowMs, attached, controller, state);
    }
    this.pending = false;
  }

  // A hand that holds a real handle stays at the place where it gripped the handle. The real and
  // the virtual world have drifted apart if the sensor still reports a grip, but the tracked hand
  // or controller leaves the handle or was never near it.
  private watchHeld(nowMs: number, controllers: Controllers, state: State) {
    for (const side of kSides) {
      const {present, gripping, real} = state.hands[side];
      const seen = kSides.filter((by) => controllers[by]);
      if (!present || !gripping || seen.length === 0) {
        this.held.delete(side);
        continue;
      }
      let held = this.held.get(side);
      if (!held) {
        const away = (by: Side) => distance(controllers[by]!.world, real.p);
        const by = seen.sort((a, b) => away(a) - away(b))[0];
        const offset: Vec3 =
            away(by) < kHandReach ? inHandle(controllers[by]!, side, state) : [0, 0, 0];
        held = {handle: side, by, offset, driftSinceMs: NaN};
        this.held.set(side, held);
      }
      const controller = controllers[held.by];
      if (controller) this.compare(nowMs, held, controller, state);
    }
  }

  private compare(nowMs: number, attached: Attached, {world}: Place, state: State) {
    const expected = vector(attached.offset).applyMatrix4(matrix(state.hands[attached.handle].real));
    const off = distance(expected.toArray(), world);
    this.drift = Number.isNaN(this.drift) ? off : Math.max(this.drift, off);
    if (off <= kDriftLimit) {
      attached.driftSinceMs = NaN;
    } else if (Number.isNaN(attached.driftSinceMs)) {
      attached.driftSinceMs = nowMs;
    } else if (nowMs - attached.driftSinceMs > kDriftMs) {
      this.driftAlarm = true;
    }
  }
}

function inHandle({world}: Place, handle: Side, state: State): Vec3 {
  return vector(world).applyMatrix4(matrix(state.hands[handle].real).invert()).toArray();
}

function tryFit(pairs: PointPair[]): Registration | null {
  try {
    return fit(pairs);
  } catch {
    return null;
  }
}

function mean(points: Vec3[]): Vec3 {
  const sum: Vec3 = [0, 0, 0];
  for (const p of points) p.forEach((v, i) => (sum[i] += v / points.length));
  return sum;
}
