// The scene contains all objects of W, under one rotation from Z up to three.js's Y up.
import {
  Box3, BufferGeometry, Group, Line, LineDashedMaterial, Mesh, MeshBasicMaterial,
  MeshStandardMaterial, Object3D, PCFShadowMap, Scene, SphereGeometry, Vector3, WebGLRenderer,
} from 'three';
import {BodyPoints} from '../person';
import {FixtureSpec, kSides, PersonState, Pose, SceneSpec, Side, State, Vec3} from '../protocol';
import {kMeaning, kSceneColors, Theme} from '../theme';
import {WrenchArrows} from './arrows';
import {Body} from './body';
import {CameraRig} from './camera';
import {place, poseIn, vector} from './frames';
import {Guidance} from './guidance';
import {Handle} from './handles';
import {Mirror} from './mirror';
import {Complaint, kPlaceholder, loadObject, makeGhost, Robot} from './models';
import {Movables} from './movables';
import {Room} from './room';

const kSlowFrameMs = 45;  // if frames take longer for a while: fewer pixels, then fewer shadows
const kPatienceMs = 3000;
const kWaitForModelsMs = 1200;   // before an empty room is drawn, because drawing delays the loading
// The maximum time for compiling the shaders in the background. After this time, the scene is drawn
// even if the shaders are not ready.
const kLongestCompileMs = 4000;
const kOverArrows = 30;  // order of drawing
const kShadowEvery = 6;  // frames, on a slow computer

// Without a graphics card, the processor draws the scene, so the page should draw less.
function drawnBySoftware(): boolean {
  const gl = document.createElement('canvas').getContext('webgl2');
  const info = gl?.getExtension('WEBGL_debug_renderer_info');
  const name = info ? String(gl!.getParameter(info.UNMASKED_RENDERER_WEBGL)) : '';
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

// Draws a line from a handle to the pointer's desired position, like a rubber band.
class Rubber {
  readonly group = new Group();
  private readonly geometry = new BufferGeometry();
  private readonly line: Line;
  private readonly end: Mesh;

  constructor(side: Side) {
    const color = kMeaning[side];
    this.line = new Line(
        this.geometry, new LineDashedMaterial(
            {color, dashSize: 0.02, gapSize: 0.012, depthTest: false, transparent: true}));
    this.line.frustumCulled = false;
    this.end = new Mesh(new SphereGeometry(0.012, 16, 12), new MeshBasicMaterial(
        {color, depthTest: false, transparent: true}));
    this.line.renderOrder = kOverArrows;
    this.end.renderOrder = kOverArrows;
    this.group.add(this.line, this.end);
    this.group.visible = false;
  }

  set(from: Vec3, to: Vec3 | null) {
    this.group.visible = to !== null;
    if (!to) return;
    this.geometry.setFromPoints([vector(from), vector(to)]);
    this.line.computeLineDistances();
    this.end.position.set(...to);
  }
}

// Returns the part of a scene description that is drawn. Results and notices do not affect this
// part.
function drawnOf(spec: SceneSpec): string {
  return JSON.stringify({...spec, results: undefined, notice: undefined});
}

export interface Thresholds {
  force: number;
  torque: number;
}

// Returns the present thresholds from the state, or otherwise the thresholds of the scenario.
export function presentThresholds(spec: SceneSpec, state: State): Thresholds {
  const force = state.parameters[3];
  const torque = state.parameters[4];
  return {
    force: force > 0 ? force : spec.thresholds.force,
    torque: torque > 0 ? torque : spec.thresholds.torque,
  };
}

export class Stage {
  readonly renderer: WebGLRenderer;
  readonly scene = new Scene();
  // Outside a headset, this pose is the identity. In a headset, it is the pose of W in the
  // headset's space, which the registration determines.
  readonly root = new Group();
  readonly world = new Group();
  readonly camera: CameraRig;
  readonly handles: Record<Side, Handle> = {left: new Handle('left'), right: new Handle('right')};
  readonly arrows = {left: new WrenchArrows(), right: new WrenchArrows()};
  readonly guidance = new Guidance();
  readonly body = new Body();
  readonly mirror = new Mirror();
  spec: SceneSpec | null = null;
  firstRenderMs = NaN;  // since the page was opened
  modelsLoaded = false;
  settled = false;  // the models are loaded and posed as in the last state
  frames = 0;
  ghosts = false;
  bodyWanted = true;
  private readonly room = new Room();
  private readonly movables = new Movables();
  private readonly rubbers = {left: new Rubber('left'), right: new Rubber('right')};
  private cobot: Robot | null = null;
  private object: Object3D | null = null;
  private readonly objectPlace = new Group();
  private arms: Partial<Record<Side, Robot>> = {};
  private ghostMaterials: MeshStandardMaterial[] = [];
  private theme: Theme = 'dark';
  token = '';  // grants access to the models and the report
  private builtMs = NaN;
  private compiled = false;
  private standing = false;  // the camera has its initial pose
  private slowMs = 0;
  private lastFrameMs = 0;

  // `complain` reports in words which parts of a model are not shown.
  constructor(private readonly container: HTMLElement, private readonly complain: Complaint) {
    const software = drawnBySoftware();
    this.renderer = new WebGLRenderer(
        {antialias: !software, powerPreference: 'high-performance'});
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.autoUpdate = !software;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.setPixelRatio(software ? 1 : Math.min(devicePixelRatio, 2));
    this.renderer.xr.enabled = true;
    this.renderer.xr.setReferenceSpaceType('local-floor');
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', 'The virtual cobot, the object and its handles. ' +
        'The operator takes a handle with L, R or B and moves it with the arrow keys.');
    container.append(canvas);
    this.world.rotation.x = -Math.PI / 2;
    this.scene.add(this.root);
    this.root.add(this.world);
    this.world.add(this.room.group, this.movables.group, this.objectPlace, this.guidance.group, this.body.group, this.mirror.group);
    for (const side of kSides) {
      this.world.add(
          this.handles[side].group, this.arrows[side].group, this.rubbers[side].group);
    }
    this.camera = new CameraRig(canvas, this.world);
    new ResizeObserver(() => this.resize()).observe(container);
    this.resize();
  }

  // Rebuilds the scene. Each model appears as soon as it is loaded. The shaders are compiled at the
  // same time.
  build(spec: SceneSpec, token: string) {
    this.token = token;
    const same = this.spec !== null && drawnOf(spec) === drawnOf(this.spec);
    this.spec = spec;
    if (same) return;
    this.builtMs = performance.now();
    this.modelsLoaded = false;
    this.settled = false;
    this.room.build(spec);
    this.guidance.build(spec);
    this.mirror.build(spec);
    this.guidance.paint(this.theme);
    this.clearModels();
    const cobot = new Robot(spec.cobot);
    this.cobot = cobot;
    this.world.add(cobot.group);
    const complain = this.oncePer('The cobot');
    const models = [
      cobot.load(this.token, complain).catch(this.toWords(complain)),
      this.loadObject(spec),
      this.movables.build(spec.movables ?? [], this.token, (name) => this.oncePer(name)),
    ];
    const drawn = drawnOf(spec);
    void Promise.all(models).then(() => (this.modelsLoaded = this.isDrawn(drawn)));
    if (this.ghosts) this.setGhosts(true);
    if (!this.compiled) this.compile();
  }

  // Before the shaders are compiled, nothing is visible.
  get drawable(): boolean {
    const waited = performance.now() - this.builtMs > kWaitForModelsMs;
    return this.spec !== null && this.compiled && this.standing && (this.modelsLoaded || waited);
  }

  // Shows the real arms next to the virtual scene. The models of the real arms are loaded at the
  // first request.
  setGhosts(on: boolean) {
    this.ghosts = on;
    this.room.setTranslucent(on);
    for (const side of kSides) {
      const spec = this.spec?.arms[side];
      if (on && spec && !this.arms[side]) {
        const arm = new Robot(spec);
        this.arms[side] = arm;
        this.world.add(arm.group);
        const complain = this.oncePer(`The ${side} arm`);
        arm.load(this.token, complain).then(() => {
          this.ghostMaterials.push(makeGhost(arm.group));
          this.paintGhosts();
        }, this.toWords(complain));
      }
      const arm = this.arms[side];
      if (arm) arm.group.visible = on;
    }
  }

  get ghostsLoaded(): boolean {
    const arms = Object.values(this.arms);
    return arms.length > 0 && arms.every((arm) => arm.loaded);
  }

  // When a state arrives, its warnings are shown immediately, even though the state itself is shown
  // later.
  warn(state: State) {
    if (!this.spec) return;
    const thresholds = presentThresholds(this.spec, state);
    for (const side of kSides) {
      this.arrows[side].reached(state.hands[side].peak, thresholds.force, thresholds.torque);
    }
  }

  setFixtures(fixtures: FixtureSpec[]) {
    this.room.setFixtures(fixtures);
  }

  setToken(token: string) {
    this.token = token;
  }

  apply(state: State, targets: Record<Side, Pose | null>) {
    if (!this.spec) return;
    if (!this.standing) {
      // The first state gives the object's position, which determines the viewpoint.
      this.standing = true;
      this.camera.jump('free', this.spec, state.object.p);
    }
    const thresholds = presentThresholds(this.spec, state);
    this.cobot?.setJoints(state.cobotQ);
    place(this.objectPlace, state.object);
    this.movables.set(state.movables);
    this.guidance.set(state.object.p);
    const byHand = this.spec.operator === 'browser' && !this.renderer.xr.isPresenting;
    for (const side of kSides) {
      const hand = state.hands[side];
      this.handles[side].setScreenScale(byHand ? this.pixelsPerMetre(hand.virtual.p) : Infinity);
      this.handles[side].set(hand, this.spec.mode !== 'direct');
      this.arrows[side].group.visible = hand.present;
      this.arrows[side].set(
          vector(hand.virtual.p), hand.wrench, thresholds.force, thresholds.torque);
      this.rubbers[side].set(hand.virtual.p, targets[side]?.p ?? null);
      this.arms[side]?.setJoints(hand.armQ);
    }
    this.settled = this.modelsLoaded;
  }

  // `points` are the body of the person, or null if it is not known. The wearer of a headset sees
  // this body only in the mirror. The operator's view begins at the head of this body.
  applyPerson(points: BodyPoints | null, parts: PersonState['parts'] | null) {
    const {body, mirror} = this;
    body.group.visible = points !== null && this.bodyWanted && !this.renderer.xr.isPresenting;
    if (mirror.group.visible) mirror.set(points, parts);
    if (!body.group.visible) return;
    body.showTrunk(!['operator', 'headset'].includes(this.camera.view));
    body.set(points!);
    body.paint(parts);
  }

  paint(theme: Theme) {
    this.theme = theme;
    this.room.paint(this.scene, theme);
    this.guidance.paint(theme);
    this.paintGhosts();
  }

  render(nowMs: number) {
    if (!this.drawable) return;
    if (!this.renderer.xr.isPresenting) this.camera.update(nowMs);
    if (this.frames % kShadowEvery === 0) this.renderer.shadowMap.needsUpdate = true;
    this.renderer.render(this.scene, this.camera.camera);
    this.frames++;
    if (Number.isNaN(this.firstRenderMs)) this.firstRenderMs = performance.now();
    this.saveTime(nowMs);
  }

  // Returns the present picture as a PNG. In a headset, or if the browser cannot make the PNG,
  // returns null.
  picture(): Promise<Blob | null> {
    if (this.renderer.xr.isPresenting) return Promise.resolve(null);
    this.renderer.render(this.scene, this.camera.camera);  // the browser discards the content of the canvas
    return new Promise((resolve) => this.renderer.domElement.toBlob(resolve));
  }

  // Returns the pose of a link of the cobot in W from the scene graph, or null if the link does not
  // exist. Other names are 'object' for the object, 'movable:NAME' for a movable object,
  // 'left:LINK' for a link of an arm, and 'left:handle' for a virtual handle.
  linkPose(name: string): Pose | null {
    const node = this.node(name);
    return node ? poseIn(node, this.world) : null;
  }

  get fixtureBoxes() {
    return this.room.fixtureBoxes;
  }

  get fixtureLabels() {
    return this.room.fixtureLabels;
  }

  // Bounding box in W of a link of the cobot, of 'object', or of 'movable:NAME', which includes
  // only visual shapes [m].
  meshBox(name: string): {min: Vec3; max: Vec3} | null {
    const link = name === 'object' ? this.object : this.node(name);
    if (!link) return null;
    const box = new Box3();
    const toWorld = this.world.matrixWorld.clone().invert();
    const visit = (node: Object3D) => {
      if ('isURDFJoint' in node && name !== 'object') return;
      if (node instanceof Mesh) {
        node.geometry.computeBoundingBox();
        box.union(node.geometry.boundingBox!.clone().applyMatrix4(
            toWorld.clone().multiply(node.matrixWorld)));
      }
      node.children.forEach(visit);
    };
    link.updateWorldMatrix(true, true);
    visit(link);
    return {min: box.min.toArray(), max: box.max.toArray()};
  }

  // Returns the number of boxes that represent meshes of the object that cannot be shown.
  get placeholders(): number {
    let count = 0;
    this.object?.traverse((node) => (count += node.name === kPlaceholder ? 1 : 0));
    return count;
  }

  // Returns the position on the page of a point in W [px].
  project(p: Vec3): {x: number; y: number} {
    const v = this.world.localToWorld(new Vector3(...p)).project(this.camera.camera);
    const box = this.renderer.domElement.getBoundingClientRect();
    return {x: box.left + ((v.x + 1) / 2) * box.width, y: box.top + ((1 - v.y) / 2) * box.height};
  }

  private isDrawn(drawn: string): boolean {
    return this.spec !== null && drawnOf(this.spec) === drawn;
  }

  // Returns the radius of a handle's ring on the page [px].
  ringOnScreen(side: Side): number {
    const {virtual, ringRadius} = this.handles[side];
    return ringRadius * this.pixelsPerMetre(virtual.position.toArray());
  }

  // Returns the scale on the page at a point in W.
  private pixelsPerMetre(p: Vec3): number {
    const {camera} = this.camera;
    const distance = camera.position.distanceTo(this.world.localToWorld(new Vector3(...p)));
    const view = 2 * distance * Math.tan((camera.fov * Math.PI) / 360);
    return this.renderer.domElement.clientHeight / Math.max(view, 0.01);
  }

  private async loadObject(spec: SceneSpec) {
    const complain = this.oncePer('The object');
    try {
      const model = await loadObject(spec.object, this.token, complain);
      if (!this.isDrawn(drawnOf(spec))) return;
      this.object = model;
      this.objectPlace.add(model);
    } catch (error) {
      this.toWords(complain)(error as Error);
    }
  }

  // Reports each kind of problem with a model only once.
  private oncePer(model: string): Complaint {
    const reported = new Set<string>();
    return (words) => {
      if (!reported.has(words)) this.complain(`${model}: ${words}`);
      reported.add(words);
    };
  }

  private toWords(complain: Complaint): (error: Error) => void {
    return (error) => complain(error.message);
  }

  // Compiles the shaders of the first visible objects in the background while models are loading.
  // The models need no other shaders.
  private compile() {
    const done = () => (this.compiled = true);
    const seen = [this.room.group, this.guidance.group, this.handles.left.group,
                  this.arrows.left.group];
    const gl = this.renderer.getContext();
    if (!gl.getExtension('KHR_parallel_shader_compile')) {
      // The browser does not report when the shaders are ready, but it starts to compile them when
      // the commands are flushed.
      for (const group of seen) this.renderer.compile(group, this.camera.camera, this.scene);
      gl.flush();
      done();
      return;
    }
    void Promise.all(seen.map((group) =>
      this.renderer.compileAsync(group, this.camera.camera, this.scene))).then(done, done);
    window.setTimeout(done, kLongestCompileMs);
  }

  private node(name: string): Object3D | null {
    if (name === 'object') return this.objectPlace;
    if (!name.includes(':')) return this.cobot?.link(name) ?? null;
    if (name.startsWith('movable:')) return this.movables.place(name.split(':')[1]);
    const [side, link] = name.split(':') as [Side, string];
    return link === 'handle' ? this.handles[side].virtual : this.arms[side]?.link(link) ?? null;
  }

  private paintGhosts() {
    const color = kSceneColors[this.theme].ghost;
    this.ghostMaterials.forEach((material) => material.color.set(color));
  }

  private clearModels() {
    this.cobot?.group.removeFromParent();
    this.object?.removeFromParent();
    for (const arm of Object.values(this.arms)) arm.group.removeFromParent();
    this.arms = {};
    this.ghostMaterials = [];
  }

  private resize() {
    if (this.renderer.xr.isPresenting) return;
    const {clientWidth, clientHeight} = this.container;
    this.renderer.setSize(clientWidth, clientHeight);
    this.camera.resize(clientWidth, clientHeight);
  }

  // On a computer without a graphics card, the page first reduces the number of pixels, and then
  // the frequency at which shadows are updated.
  private saveTime(nowMs: number) {
    const frameMs = nowMs - this.lastFrameMs;
    this.lastFrameMs = nowMs;
    if (this.renderer.xr.isPresenting) return;
    this.slowMs = frameMs > kSlowFrameMs ? this.slowMs + Math.min(frameMs, 500) : 0;
    if (this.slowMs < kPatienceMs) return;
    this.slowMs = 0;
    if (this.renderer.getPixelRatio() > 1) {
      this.renderer.setPixelRatio(1);
      this.resize();
    } else {
      this.renderer.shadowMap.autoUpdate = false;
    }
  }
}
