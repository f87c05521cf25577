// The registration as a person does it in the headset: touch known points, or put the controllers on
// the handles; and the watch over it afterwards.
import {kSides, SceneSpec, Side, State, Vec3} from '../protocol';
import {distance, matrix, vector} from '../scene/frames';
import {fit, load, PointPair, Registration, store} from './registration';

const kMountMs = 4000;     // to put the controllers on the handles
const kMeasureMs = 500;    // of which the last are averaged
const kDriftLimit = 0.03;  // [m]
const kDriftMs = 500;      // that it lasts before it is told

interface Point {
  words: string;
  known(state: State): Vec3;
}

interface Attached {
  offset: Vec3;        // of the controller in the handle's frame [m]
  driftSinceMs: number;
}

export class Registrar {
  registration: Registration | null = null;
  drift = NaN;          // largest of the attached controllers [m]
  prompt = '';
  recentred = false;    // by the headset's own menu: what was measured holds no more
  private touching: {points: Point[]; pairs: PointPair[]} | null = null;
  private mounting: {startMs: number; samples: Record<Side, Vec3[]>} | null = null;
  private readonly attached = new Map<Side, Attached>();
  private pending = false;  // offsets are taken in the first frame of the new registration
  private driftAlarm = false;

  constructor(private readonly changed: (registration: Registration) => void) {}

  begin(spec: SceneSpec) {
    this.registration = load(spec.name);
    this.recentred = false;
    this.cancel('');
  }

  get waitsForTouch(): boolean {
    return this.touching !== null;
  }

  get controllersAttached(): boolean {
    return this.attached.size > 0;
  }

  // Begins, or gives up, the touching of points.
  toggleTouching(spec: SceneSpec, state: State) {
    if (this.touching) return this.cancel('Registration cancelled.');
    this.cancel('');
    const points: Point[] = kSides.filter((side) => state.hands[side].present).map((side) => ({
      words: `the ${side} handle`, known: (s) => s.hands[side].real.p,
    }));
    points.push({words: 'the middle of the cobot’s base', known: () => spec.cobot.base.p});
    this.touching = {points, pairs: []};
    this.askForPoint();
  }

  // A point was touched: in the headset's space, Z up.
  touch(touched: Vec3, spec: SceneSpec, state: State) {
    if (!this.touching) return;
    const {points, pairs} = this.touching;
    pairs.push({touched, known: points[pairs.length].known(state)});
    if (pairs.length < points.length) return this.askForPoint();
    this.touching = null;
    this.finish(pairs, spec);
  }

  // Begins, or gives up, the way by controllers on the handles.
  toggleMounting(nowMs: number) {
    if (this.mounting) return this.cancel('Registration cancelled.');
    this.cancel('');
    this.mounting = {startMs: nowMs, samples: {left: [], right: []}};
  }

  // Each frame: positions of the controllers in the headset's space (Z up), and in W.
  update(nowMs: number, controllers: Partial<Record<Side, {space: Vec3; world: Vec3}>>,
         spec: SceneSpec, state: State) {
    this.watch(nowMs, controllers, state);
    if (this.mounting) this.mount(nowMs, controllers, spec, state);
  }

  get alarm(): string {
    if (this.recentred) return 'The headset was re-centred: register again.';
    return this.driftAlarm ?
      `Registration is off by ${(1000 * this.drift).toFixed(0)} mm: register again.` : '';
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

  private finish(pairs: PointPair[], spec: SceneSpec): boolean {
    try {
      this.registration = fit(pairs);
    } catch (error) {
      this.prompt = `Not registered. ${(error as Error).message}`;
      return false;
    }
    store(spec.name, this.registration);
    this.recentred = false;
    this.attached.clear();
    this.drift = NaN;
    this.prompt = `Registered. Residual ${(1000 * this.registration.residual).toFixed(1)} mm.`;
    this.changed(this.registration);
    return true;
  }

  private mount(nowMs: number, controllers: Partial<Record<Side, {space: Vec3; world: Vec3}>>,
                spec: SceneSpec, state: State) {
    const {startMs, samples} = this.mounting!;
    const leftMs = startMs + kMountMs - nowMs;
    this.prompt = 'Put the left controller on the left handle, the right one on the right: ' +
        `measured in ${Math.max(leftMs / 1000, 0).toFixed(0)} s.`;
    const sides = kSides.filter((side) => state.hands[side].present);
    if (leftMs < kMeasureMs) {
      sides.forEach((side) => controllers[side] && samples[side].push(controllers[side]!.space));
    }
    if (leftMs > 0) return;
    this.mounting = null;
    const measured = sides.filter((side) => samples[side].length > 0);
    const pairs = measured.map((side) => ({
      touched: mean(samples[side]), known: state.hands[side].real.p,
    }));
    if (!this.finish(pairs, spec)) return;
    // Where each controller sits on its handle: by the registration just made.
    for (const side of measured) this.attached.set(side, {offset: [0, 0, 0], driftSinceMs: NaN});
    this.pending = true;
  }

  private watch(nowMs: number, controllers: Partial<Record<Side, {space: Vec3; world: Vec3}>>,
                state: State) {
    this.drift = NaN;
    this.driftAlarm = false;
    for (const [side, attached] of this.attached) {
      const controller = controllers[side];
      if (!controller) continue;
      const handle = matrix(state.hands[side].real);
      if (this.pending) {
        const p = vector(controller.world).applyMatrix4(handle.clone().invert());
        attached.offset = p.toArray();
      }
      const expected = vector(attached.offset).applyMatrix4(handle).toArray();
      const off = distance(expected, controller.world);
      this.drift = Number.isNaN(this.drift) ? off : Math.max(this.drift, off);
      if (off <= kDriftLimit) {
        attached.driftSinceMs = NaN;
      } else if (Number.isNaN(attached.driftSinceMs)) {
        attached.driftSinceMs = nowMs;
      } else if (nowMs - attached.driftSinceMs > kDriftMs) {
        this.driftAlarm = true;
      }
    }
    this.pending = false;
  }
}

function mean(points: Vec3[]): Vec3 {
  const sum: Vec3 = [0, 0, 0];
  for (const p of points) p.forEach((v, i) => (sum[i] += v / points.length));
  return sum;
}
