// The scene: everything of W under one rotation from Z up to three.js's Y up.
import {
  Box3, BufferGeometry, Group, Line, LineDashedMaterial, Mesh, MeshBasicMaterial,
  MeshStandardMaterial, Object3D, PCFShadowMap, Scene, SphereGeometry, Vector3, WebGLRenderer,
} from 'three';
import {kSides, Pose, SceneSpec, Side, State, Vec3} from '../protocol';
import {kMeaning, kSceneColors, Theme} from '../theme';
import {WrenchArrows} from './arrows';
import {CameraRig} from './camera';
import {place, poseIn, vector} from './frames';
import {Guidance} from './guidance';
import {Handle} from './handles';
import {loadObject, makeGhost, Robot} from './models';
import {Room} from './room';

const kSlowFrameMs = 45;  // longer ones, for a while: fewer pixels, then fewer shadows
const kPatienceMs = 3000;
const kOverArrows = 30;  // order of drawing
const kShadowEvery = 6;  // frames, on a slow computer

// No graphics card: then the processor draws, and should draw less.
function drawnBySoftware(): boolean {
  const gl = document.createElement('canvas').getContext('webgl2');
  const info = gl?.getExtension('WEBGL_debug_renderer_info');
  const name = info ? String(gl!.getParameter(info.UNMASKED_RENDERER_WEBGL)) : '';
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

// A line from a handle to where the pointer wants it, like a rubber band.
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

export interface Thresholds {
  force: number;
  torque: number;
}

// Present thresholds: as ramped, else the scenario's.
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
  // Outside a headset: the identity. Inside: where W is in the headset's space (registration).
  readonly root = new Group();
  readonly world = new Group();
  readonly camera: CameraRig;
  readonly handles: Record<Side, Handle> = {left: new Handle('left'), right: new Handle('right')};
  readonly arrows = {left: new WrenchArrows(), right: new WrenchArrows()};
  readonly guidance = new Guidance();
  spec: SceneSpec | null = null;
  firstRenderMs = NaN;  // since the page was opened
  modelsLoaded = false;
  settled = false;  // the models are loaded and stand as the last state has them
  frames = 0;
  ghosts = false;
  private readonly room = new Room();
  private readonly rubbers = {left: new Rubber('left'), right: new Rubber('right')};
  private cobot: Robot | null = null;
  private object: Object3D | null = null;
  private readonly objectPlace = new Group();
  private arms: Partial<Record<Side, Robot>> = {};
  private ghostMaterials: MeshStandardMaterial[] = [];
  private theme: Theme = 'dark';
  private token = '';
  private slowMs = 0;
  private lastFrameMs = 0;

  constructor(private readonly container: HTMLElement, private readonly failed: (e: Error) => void) {
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
    canvas.setAttribute('aria-label', 'The virtual cobot, the object and its handles');
    container.append(canvas);
    this.world.rotation.x = -Math.PI / 2;
    this.scene.add(this.root);
    this.root.add(this.world);
    this.world.add(this.room.group, this.objectPlace, this.guidance.group);
    for (const side of kSides) {
      this.world.add(
          this.handles[side].group, this.arrows[side].group, this.rubbers[side].group);
    }
    this.camera = new CameraRig(canvas, this.world);
    new ResizeObserver(() => this.resize()).observe(container);
    this.resize();
  }

  // Builds the scene anew; models follow as they load.
  build(spec: SceneSpec, object: Vec3, token: string) {
    this.token = token;
    if (JSON.stringify(spec) === JSON.stringify(this.spec)) return;
    const first = this.spec === null;
    this.spec = spec;
    this.modelsLoaded = false;
    this.settled = false;
    this.room.build(spec);
    this.guidance.build(spec);
    this.guidance.paint(this.theme);
    this.clearModels();
    if (first) this.camera.jump('free', spec, object);
    const cobot = new Robot(spec.cobot);
    this.cobot = cobot;
    this.world.add(cobot.group);
    const models = [
      cobot.load(token),
      loadObject(spec.object, token).then((model) => {
        this.object = model;
        if (this.spec === spec) this.objectPlace.add(model);
      }),
    ];
    Promise.all(models).then(() => (this.modelsLoaded = true), this.failed);
    if (this.ghosts) this.setGhosts(true);
  }

  // The real arms, beside the virtual scene; loaded when first asked for.
  setGhosts(on: boolean) {
    this.ghosts = on;
    this.room.setTranslucent(on);
    for (const side of kSides) {
      const spec = this.spec?.arms[side];
      if (on && spec && !this.arms[side]) {
        const arm = new Robot(spec);
        this.arms[side] = arm;
        this.world.add(arm.group);
        arm.load(this.token).then(() => {
          this.ghostMaterials.push(makeGhost(arm.group));
          this.paintGhosts();
        }, this.failed);
      }
      const arm = this.arms[side];
      if (arm) arm.group.visible = on;
    }
  }

  get ghostsLoaded(): boolean {
    const arms = Object.values(this.arms);
    return arms.length > 0 && arms.every((arm) => arm.loaded);
  }

  apply(state: State, targets: Record<Side, Pose | null>) {
    if (!this.spec) return;
    const thresholds = presentThresholds(this.spec, state);
    this.cobot?.setJoints(state.cobotQ);
    place(this.objectPlace, state.object);
    this.guidance.set(state.object.p);
    for (const side of kSides) {
      const hand = state.hands[side];
      this.handles[side].set(hand, this.spec.mode !== 'direct');
      this.arrows[side].group.visible = hand.present;
      this.arrows[side].set(
          vector(hand.virtual.p), hand.wrench, thresholds.force, thresholds.torque);
      this.rubbers[side].set(hand.virtual.p, targets[side]?.p ?? null);
      this.arms[side]?.setJoints(hand.armQ);
    }
    this.settled = this.modelsLoaded;
  }

  paint(theme: Theme) {
    this.theme = theme;
    this.room.paint(this.scene, theme);
    this.guidance.paint(theme);
    this.paintGhosts();
  }

  render(nowMs: number) {
    if (!this.renderer.xr.isPresenting) this.camera.update(nowMs);
    if (this.frames % kShadowEvery === 0) this.renderer.shadowMap.needsUpdate = true;
    this.renderer.render(this.scene, this.camera.camera);
    this.frames++;
    if (Number.isNaN(this.firstRenderMs) && this.spec) this.firstRenderMs = performance.now();
    this.saveTime(nowMs);
  }

  // Pose of a link of the cobot ('object': of the object; 'left:LINK': of an arm; 'left:handle': of a
  // virtual handle) in W, from the scene graph; null if there is none.
  linkPose(name: string): Pose | null {
    const node = this.node(name);
    return node ? poseIn(node, this.world) : null;
  }

  // Of the visuals that hang on a link of the cobot alone, in W [m].
  meshBox(name: string): {min: Vec3; max: Vec3} | null {
    const link = this.cobot?.link(name);
    if (!link) return null;
    const box = new Box3();
    const toWorld = this.world.matrixWorld.clone().invert();
    const visit = (node: Object3D) => {
      if ('isURDFJoint' in node) return;
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

  // Of a point in W on the page [px].
  project(p: Vec3): {x: number; y: number} {
    const v = this.world.localToWorld(new Vector3(...p)).project(this.camera.camera);
    const box = this.renderer.domElement.getBoundingClientRect();
    return {x: box.left + ((v.x + 1) / 2) * box.width, y: box.top + ((1 - v.y) / 2) * box.height};
  }

  private node(name: string): Object3D | null {
    if (name === 'object') return this.objectPlace;
    if (!name.includes(':')) return this.cobot?.link(name) ?? null;
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

  // On a computer without a graphics card: fewer pixels first, then shadows less often.
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
