// Loads robots and objects from the server's URDF files. Each request must contain the token.
import {
  BufferGeometry, BoxGeometry, Color, CylinderGeometry, EdgesGeometry, Group, LineBasicMaterial,
  LineSegments, LoadingManager, Material, Mesh, MeshPhongMaterial, MeshStandardMaterial, Object3D,
  SphereGeometry, SRGBColorSpace,
} from 'three';
import {OBJLoader} from 'three/examples/jsm/loaders/OBJLoader.js';
import {STLLoader} from 'three/examples/jsm/loaders/STLLoader.js';
import URDFLoader, {URDFRobot} from 'urdf-loader';
import {ObjectSpec, RobotSpec} from '../protocol';
import {ColladaModel, parseCollada} from './collada';
import {place} from './frames';
import {weld} from './weld';

async function fetchModel(url: string, token: string): Promise<Response> {
  const response = await fetch(url, {headers: {Authorization: `Bearer ${token}`}});
  if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
  return response;
}

// Uses the same lighting for all materials, regardless of the file's lighting model.
function standard(material: Material): MeshStandardMaterial {
  const color = (material as MeshPhongMaterial).color ?? new Color(0xcccccc);
  return new MeshStandardMaterial({color: color.clone(), roughness: 0.55, metalness: 0.08});
}

function finish(root: Object3D) {
  const converted = new Map<Material, MeshStandardMaterial>();
  const convert = (material: Material) => {
    if (!converted.has(material)) converted.set(material, standard(material));
    return converted.get(material)!;
  };
  root.traverse((node) => {
    if (!(node instanceof Mesh)) return;
    node.material = Array.isArray(node.material) ? node.material.map(convert) :
                                                   convert(node.material);
    node.geometry = weld(node.geometry);
    node.castShadow = true;
    node.receiveShadow = true;
  });
}

// Reports a part that could not be loaded or is not shown. The other parts are still shown. This
// callback is called once per model.
export type Complaint = (words: string) => void;

export const kPlaceholder = 'placeholder';
const kPlaceholderSize = 0.06;  // size of the box that represents a mesh that cannot be shown [m]

// Loads a mesh file in any format that robots commonly use. Throws an Error if the file has another
// format, is missing, or cannot be parsed.
async function loadMesh(url: string, token: string, material: Material,
                        complain: Complaint): Promise<Object3D> {
  const kind = url.slice(url.lastIndexOf('.') + 1).toLowerCase();
  if (!['dae', 'stl', 'obj'].includes(kind)) throw new Error(`${url}: a mesh is .dae, .stl or .obj`);
  const response = await fetchModel(url, token);
  if (kind === 'stl') {
    return new Mesh(new STLLoader().parse(await response.arrayBuffer()), material);
  }
  if (kind === 'obj') return withMaterial(new OBJLoader().parse(await response.text()), material);
  const {scene, textured} = readCollada(url, await response.text());
  if (textured) complain('its textures are not shown, only its colours.');
  // Lights and cameras of the modelling program do not belong to the robot.
  const strays: Object3D[] = [];
  scene.traverse((node) => {
    if ('isLight' in node || 'isCamera' in node) strays.push(node);
  });
  strays.forEach((node) => node.removeFromParent());
  return scene;
}

function readCollada(url: string, text: string): ColladaModel {
  try {
    return parseCollada(text);
  } catch (error) {
    throw new Error(`${url}: ${(error as Error).message}`);
  }
}

// An .obj file names its materials in a separate file, which the server does not provide. The
// URDF's material is used instead.
function withMaterial(root: Object3D, material: Material): Object3D {
  root.traverse((node) => {
    if (node instanceof Mesh) node.material = material;
  });
  return root;
}

// A wire box that replaces a mesh that cannot be shown. The wire box shows where a part is missing.
function placeholder(): Object3D {
  const box = new BoxGeometry(kPlaceholderSize, kPlaceholderSize, kPlaceholderSize);
  const mesh = new LineSegments(new EdgesGeometry(box), new LineBasicMaterial({color: 0xff9f1c}));
  mesh.name = kPlaceholder;
  return mesh;
}

// Removes these links and all parts that are attached to them.
function removeLinks(xml: Document, names: string[]) {
  const joints = () => [...xml.querySelectorAll('robot > joint')];
  const pending = [...names];
  for (let name = pending.pop(); name !== undefined; name = pending.pop()) {
    xml.querySelector(`robot > link[name="${CSS.escape(name)}"]`)?.remove();
    for (const joint of joints()) {
      const parent = joint.querySelector('parent')?.getAttribute('link');
      const child = joint.querySelector('child')?.getAttribute('link');
      if (parent === name && child) pending.push(child);
      if (parent === name || child === name) joint.remove();
    }
  }
}

// Loads a URDF with its meshes. A placeholder replaces a mesh that cannot be shown. Throws an Error
// if the URDF itself is missing or cannot be parsed.
export async function loadUrdf(url: string, removed: string[], token: string,
                               complain: Complaint): Promise<URDFRobot> {
  const text = await (await fetchModel(url, token)).text();
  const xml = new DOMParser().parseFromString(text, 'application/xml');
  if (xml.querySelector('parsererror')) throw new Error(`${url}: not well-formed`);
  removeLinks(xml, removed);
  const textures = [...xml.querySelectorAll('texture')];
  if (textures.length > 0) complain('its textures are not shown, only its colours.');
  textures.forEach((texture) => texture.remove());
  const loader = new URDFLoader(new LoadingManager());
  loader.workingPath = url.slice(0, url.lastIndexOf('/') + 1);
  const meshes: Promise<void>[] = [];
  loader.loadMeshCb = (path, _manager, material, done) => {
    meshes.push(loadMesh(path, token, material, complain).catch((error: Error) => {
      complain(`${error.message}. A wireframe box replaces it.`);
      return placeholder();
    }).then((mesh) => done(mesh)));
  };
  const robot = loader.parse(xml);
  // Measured positions must be visible even beyond a joint limit.
  Object.values(robot.joints).forEach((joint) => (joint.ignoreLimits = true));
  await Promise.all(meshes);
  finish(robot);
  return robot;
}

// A robot whose joints follow the states.
export class Robot {
  readonly group = new Group();
  private robot: URDFRobot | null = null;

  constructor(readonly spec: RobotSpec) {
    place(this.group, spec.base);
  }

  get loaded(): boolean {
    return this.robot !== null;
  }

  async load(token: string, complain: Complaint): Promise<void> {
    this.robot = await loadUrdf(this.spec.urdf, this.spec.remove_links, token, complain);
    this.group.add(this.robot);
  }

  // Sets the joint positions in the order of spec.joints [rad].
  setJoints(q: number[]) {
    if (!this.robot) return;
    this.spec.joints.forEach((name, i) => this.robot!.setJointValue(name, q[i]));
  }

  link(name: string): Object3D | null {
    return this.robot?.links[name] ?? null;
  }
}

function shapeGeometry(spec: {shape: string; size: number[]}): BufferGeometry {
  const [x, y, z] = spec.size;
  if (spec.shape === 'sphere') return new SphereGeometry(x, 48, 32);
  if (spec.shape === 'box') return new BoxGeometry(x, y, z);
  return new CylinderGeometry(x, x, y, 48).rotateX(Math.PI / 2);  // along Z, as in URDF
}

// Loads the carried object or a movable object.
export async function loadObject(spec: ObjectSpec, token: string,
                                 complain: Complaint): Promise<Object3D> {
  if ('urdf' in spec) return loadUrdf(spec.urdf, [], token, complain);
  const mesh = new Mesh(shapeGeometry(spec), new MeshStandardMaterial(
      {color: spec.color ? new Color().setRGB(...spec.color, SRGBColorSpace) : 0xc29a6b}));
  finish(mesh);
  return mesh;
}

// Makes a model translucent, so that it does not distract from the model next to it. The depth of
// the model is drawn first, so that only its nearest surface is visible.
export function makeGhost(root: Object3D) {
  const material = new MeshStandardMaterial({
    transparent: true, opacity: 0.3, depthWrite: false, roughness: 0.9, metalness: 0,
  });
  const depth = new MeshStandardMaterial({colorWrite: false, transparent: true});
  const meshes: Mesh[] = [];
  root.traverse((node) => {
    if (node instanceof Mesh) meshes.push(node);
  });
  for (const mesh of meshes) {
    mesh.material = material;
    mesh.castShadow = false;
    mesh.receiveShadow = false;
    mesh.renderOrder = 2;
    const first = new Mesh(mesh.geometry, depth);
    first.renderOrder = 1;
    mesh.add(first);
  }
  return material;
}
