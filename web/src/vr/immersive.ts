// Shows the scene in a headset (WebXR) at true scale, with the person's hands on the handles and
// the run's state on a board. Only the person's own motion moves the view.
import {Matrix4, Mesh, PerspectiveCamera, Raycaster, Vector3} from 'three';
import {Connection} from '../connection';
import {Hands} from '../hands';
import {kSides, Pose, SceneSpec, Side, State, Vec3} from '../protocol';
import {matrix, poseOf, vector} from '../scene/frames';
import {presentThresholds, Stage} from '../scene/stage';
import {
  dangerWords, kWarningLevel, level, readable, stateWords, stopWords, Trouble,
} from '../words';
import {AlarmBell} from '../watch';
import {Board, HandLevel, PlateName} from './board';
import {Input, Inputs} from './inputs';
import {Controllers, Registrar} from './registrar';
import {applyTo, clearFrom, standAt, zUp} from './registration';
import {Tone} from './tone';

const kGrabDistance = 0.12;   // maximum distance of a hand from a handle [m]
const kReportMs = 20;         // shortest time between reports, so that 30 to 45 are sent per second
const kPulseEveryMs = 100;    // period of haptic pulses
const kPulseMs = 70;
const kMirrorEvery = 3;       // frames, for the experimenter's page
const kBoardBelowEyes = 0.3;  // distance of the board's centre below the eyes [m]
const kHeightSpeed = 0.25;    // vertical speed set by the thumbstick, before a registration [m/s]

interface Grab {
  side: Side;               // side of the handle
  handleFromInput: Matrix4; // pose of the handle in the input's frame when it was grabbed
}

export class Immersive {
  readonly board = new Board();
  readonly tone = new Tone();
  readonly registrar: Registrar;
  counters = {frames: 0, pulses: 0, reports: 0, mirrored: 0};
  session: XRSession | null = null;
  drawnNs = 0;  // wallNs of the newest drawn state; 0: none yet, or virtual time
  readonly tips: Record<Side, Vec3 | null> = {left: null, right: null};
  private readonly inputs = new Inputs();
  private readonly grabs = new Map<XRInputSource, Grab>();
  private readonly rays = new Raycaster();
  private readonly mirror = new PerspectiveCamera(75, 1, 0.05, 40);
  private readonly pulsedMs: Record<Side, number> = {left: 0, right: 0};
  private reportedMs = -Infinity;
  private lastMs = 0;
  private readonly bell = new AlarmBell();

  constructor(private readonly stage: Stage, private readonly hands: Hands,
              private readonly connection: Connection, private readonly mayGrip: () => boolean,
              private readonly stop: () => void,
              private readonly troubleNow: () => Trouble | null,
              private readonly toggleMirror: () => void) {
    this.registrar = new Registrar((registration) => applyTo(stage.root, registration));
    stage.world.add(this.board.group);
    stage.scene.add(this.inputs.group);
  }

  static async supported(): Promise<boolean> {
    return (await navigator.xr?.isSessionSupported('immersive-vr').catch(() => false)) ?? false;
  }

  // This function must be called while the browser handles a user action. Throws an Error if the
  // headset refuses.
  async enter(spec: SceneSpec, state: State): Promise<void> {
    this.tone.unlock();
    const session = await navigator.xr!.requestSession('immersive-vr', {
      requiredFeatures: ['local-floor'], optionalFeatures: ['hand-tracking'],
    });
    // From this moment on, the wearer sees only this session, so the run monitors the time until
    // the first frame.
    this.connection.send({type: 'immersive', active: true});
    session.addEventListener('end', () => this.left());
    this.inputs.listen(session);
    const {xr} = this.stage.renderer;
    await xr.setSession(session);
    xr.setFoveation(1);
    xr.getReferenceSpace()?.addEventListener('reset', () => (this.registrar.recentred = true));
    this.session = session;
    this.bell.rings(state, this.troubleNow() !== null);  // known faults do not ring the bell
    this.registrar.begin(spec);
    const {eye, forward, ground} = spec.viewpoint;
    applyTo(this.stage.root,
            this.registrar.registration ?? standAt(eye, forward, ground?.[2] ?? 0));
  }

  // While the headset shows the scene, call this function once per frame, before the frame is
  // drawn. The stop button and the message about a lost run work without the headset's pose and
  // without a state.
  update(frame: XRFrame, spec: SceneSpec | null, state: State | null, nowMs: number) {
    this.counters.frames++;
    if (this.inputs.stopPressed(frame.session)) this.stop();
    this.updateBoard(spec, state);
    const space = this.stage.renderer.xr.getReferenceSpace();
    const viewer = space && frame.getViewerPose(space);
    if (!space || !viewer || !spec || !state) return;
    this.stage.root.updateMatrixWorld(true);
    const head = new Matrix4().fromArray(viewer.transform.matrix);
    if (!this.board.group.visible) {
      this.placeBoard(
          spec, state.object.p, new Vector3().setFromMatrixPosition(this.inWorld(head)));
    }
    const inputs = this.inputs.read(frame, space);
    for (const {side, tip} of inputs) if (side) this.tips[side] = tip.toArray();
    this.press(inputs, spec, state);
    this.follow(inputs);
    const eyes = new Vector3().setFromMatrixPosition(head);
    this.registrar.update(
        nowMs, this.positions(inputs), zUp(eyes.x, eyes.y, eyes.z), spec, state);
    this.adjustHeight(inputs, nowMs);
    this.warn(inputs, spec, state, nowMs);
    this.report(head, nowMs);
  }

  // Shows the headset's view on the page. Call this function after the headset's frame was drawn.
  drawMirror() {
    const {renderer, scene, camera} = this.stage;
    if (this.counters.frames % kMirrorEvery !== 0 || !ownFramebuffer(renderer.xr.getBaseLayer())) {
      return;
    }
    const head = renderer.xr.getCamera();
    this.mirror.aspect = camera.camera.aspect;
    this.mirror.updateProjectionMatrix();
    head.matrixWorld.decompose(this.mirror.position, this.mirror.quaternion, new Vector3());
    const target = renderer.getRenderTarget();
    renderer.xr.enabled = false;
    renderer.setRenderTarget(null);
    renderer.render(scene, this.mirror);
    renderer.setRenderTarget(target);
    renderer.xr.enabled = true;
    this.counters.mirrored++;
  }

  private left() {
    this.session = null;
    this.connection.send({type: 'immersive', active: false});
    this.hands.releaseAll();
    this.grabs.clear();
    this.inputs.clear();
    this.board.group.visible = false;
    clearFrom(this.stage.root);
  }

  // Places the board at arm's length next to the object, so that it is below the eyes and faces
  // them.
  private placeBoard(spec: SceneSpec, object: Vec3, head: Vector3) {
    const {forward} = spec.viewpoint;
    const left = new Vector3(-forward[1], forward[0], 0);
    const at = vector(object).addScaledVector(left, 0.55).addScaledVector(vector(forward), -0.1)
                   .setZ(head.z - kBoardBelowEyes);
    const normal = head.clone().sub(at).normalize();
    const right = new Vector3(0, 0, 1).cross(normal).normalize();
    const up = normal.clone().cross(right);
    const {group} = this.board;
    group.position.copy(at);
    group.quaternion.setFromRotationMatrix(new Matrix4().makeBasis(right, up, normal));
    group.updateMatrixWorld(true);
    group.visible = true;
  }

  private press(inputs: Input[], spec: SceneSpec, state: State) {
    const touched = this.board.touched(inputs.map((input) => input.tip));
    touched.forEach((plate) => this.plate(plate, spec, state));
    for (const input of inputs) {
      if (!input.closing) continue;
      const pointed = this.pointedPlate(input);
      if (pointed) {
        this.plate(pointed, spec, state);
      } else if (this.registrar.waitsForTouch) {
        this.registrar.touch(zUp(input.tip.x, input.tip.y, input.tip.z), spec, state);
      } else {
        this.registrar.check(this.inW(input.tip), state);
        this.grab(input, state);
      }
    }
  }

  private plate(name: PlateName, spec: SceneSpec, state: State) {
    if (name === 'stop') this.stop();
    if (name === 'touch') this.registrar.toggleTouching(spec, state);
    if (name === 'attach') this.registrar.toggleMounting();
    if (name === 'mirror') this.toggleMirror();
  }

  private pointedPlate(input: Input): PlateName | null {
    if (!input.ray) return null;
    this.rays.set(input.ray.origin, input.ray.direction);
    return this.board.plateOf(this.rays.intersectObjects<Mesh>(this.board.bodies, false)[0]?.object);
  }

  private grab(input: Input, state: State) {
    if (!this.mayGrip()) return;
    const inW = this.inWorld(input.grip);
    const at = new Vector3().setFromMatrixPosition(inW);
    const free = kSides.filter((side) => state.hands[side].present && !this.hands.targets[side]);
    const reach = (side: Side) => at.distanceTo(vector(state.hands[side].virtual.p));
    const side = free.sort((a, b) => reach(a) - reach(b))[0];
    if (!side || reach(side) > kGrabDistance) return;
    const handle = state.hands[side].virtual;
    this.grabs.set(
        input.source, {side, handleFromInput: inW.clone().invert().multiply(matrix(handle))});
    this.hands.hold(side, handle);
  }

  private follow(inputs: Input[]) {
    for (const [source, {side, handleFromInput}] of this.grabs) {
      const input = inputs.find((i) => i.source === source);
      if (!input?.closed || !this.mayGrip()) {
        this.grabs.delete(source);
        this.hands.release(side);
      } else {
        this.hands.hold(side, poseOf(this.inWorld(input.grip).multiply(handleFromInput)));
      }
    }
  }

  private positions(inputs: Input[]): Controllers {
    const positions: Controllers = {};
    for (const {side, grip} of inputs) {
      if (!side) continue;
      const p = new Vector3().setFromMatrixPosition(grip);
      positions[side] = {
        space: zUp(p.x, p.y, p.z), world: this.stage.world.worldToLocal(p.clone()).toArray(),
      };
    }
    return positions;
  }

  // Until the world is registered to real points, the person may raise or lower the world.
  private adjustHeight(inputs: Input[], nowMs: number) {
    const dt = Math.min((nowMs - this.lastMs) / 1000, 0.1);
    this.lastMs = nowMs;
    const stick = inputs.map((input) => input.stick).find((value) => Math.abs(value) > 0.3) ?? 0;
    if (!this.registrar.registration) this.stage.root.position.y += stick * kHeightSpeed * dt;
  }

  // Sends a pulse to the controller that holds or touches a handle whose force or torque approaches
  // its threshold.
  private warn(inputs: Input[], spec: SceneSpec, state: State, nowMs: number) {
    for (const side of kSides) {
      const ratio = handLevel(side, spec, state).part;
      if (ratio < kWarningLevel || nowMs - this.pulsedMs[side] < kPulseEveryMs) continue;
      const holder = inputs.find((input) => this.grabs.get(input.source)?.side === side) ??
          (this.registrar.controllersAttached ? inputs.find((i) => i.side === side) : undefined);
      const actuator = holder?.source.gamepad?.hapticActuators?.[0];
      if (!actuator) continue;
      this.pulsedMs[side] = nowMs;
      this.counters.pulses++;
      const strength = Math.min(0.4 + (3 * (ratio - kWarningLevel)), 1);
      void actuator.pulse(strength, kPulseMs);
    }
  }

  private updateBoard(spec: SceneSpec | null, state: State | null) {
    const trouble = this.troubleNow();
    if (this.bell.rings(state, trouble !== null)) this.tone.play();
    const words = trouble ?? (state ? stateWords(state) : null);
    const stop = state && !trouble ? stopWords(state, !!spec?.simulated) : null;
    const instruction = state?.state === 'RUN' ? spec?.script[state.action]?.text : undefined;
    const danger = state && spec && !trouble ? dangerWords(state, spec.simulated) : '';
    this.board.show({
      title: words?.title ?? 'Connected',
      tone: words?.tone ?? 'stopped',
      text: trouble ? (trouble.emergency ? `${trouble.emergency}.` : trouble.meaning) : stop?.cause ?? instruction ?? words?.meaning ?? '',
      advice: danger || (stop?.advice ?? (spec && !spec.simulated ? 'Leaving VR stops the real arms.' : '')),
      hands: spec && state ? kSides.filter((side) => state.hands[side].present)
                                 .map((side) => handLevel(side, spec, state)) : [],
      prompt: this.registrar.prompt,
      alarm: this.registrar.alarm,
    });
  }

  private report(head: Matrix4, nowMs: number) {
    if (nowMs - this.reportedMs < kReportMs) return;
    this.reportedMs = nowMs;
    // Sends the head's pose only to servers that forward it to the other pages.
    const forwarded = this.connection.features.includes('headset');
    const pose: Partial<Pose> = forwarded ? poseOf(this.inWorld(head)) : {};
    const {registrar, connection: {clock}} = this;
    const measured = registrar.valid && clock.known ? {
      registration: registrar.registration!,
      posed: Math.round((performance.now() + clock.offsetMs) * 1e6),
    } : {};
    // Reports the time of the drawn state and not the time of sending, because a page with a frozen
    // picture may still send messages.
    const drawn = this.drawnNs > 0 ? {drawn: this.drawnNs} : {};
    if (this.connection.send({type: 'immersive', active: true, ...drawn, ...pose, ...measured})) {
      this.counters.reports++;
    }
  }

  // Converts a point in the headset's space to W.
  private inW(p: Vector3): Vec3 {
    return this.stage.world.worldToLocal(p.clone()).toArray();
  }

  // Converts from the headset's space to W.
  private inWorld(m: Matrix4): Matrix4 {
    return this.stage.world.matrixWorld.clone().invert().multiply(m);
  }
}

// Returns the force or the torque of a hand, whichever is nearer to its threshold.
function handLevel(side: Side, spec: SceneSpec, state: State): HandLevel {
  const thresholds = presentThresholds(spec, state);
  const {wrench} = state.hands[side];
  const [force, torque] = [wrench.slice(0, 3), wrench.slice(3)].map((v) => Math.hypot(...v));
  const byTorque = torque / thresholds.torque > force / thresholds.force;
  const [value, threshold] =
      byTorque ? [torque, thresholds.torque] : [force, thresholds.force];
  return {
    side, quantity: byTorque ? 'torque' : 'force', part: value / threshold,
    level: level(value, threshold),
    text: byTorque ? `${value.toFixed(1)} / ${readable(threshold, 'torque')}` :
                     `${value.toFixed(0)} / ${threshold.toFixed(0)} N`,
  };
}

// Returns whether the headset draws into its own framebuffer, so that the page's canvas is free for
// a mirror. On a standalone headset, other people do not see the page.
function ownFramebuffer(layer: XRWebGLLayer | XRProjectionLayer | null): boolean {
  if (!layer || /OculusBrowser|Pico|Quest/i.test(navigator.userAgent)) return false;
  return !('framebuffer' in layer) || layer.framebuffer !== null;
}
