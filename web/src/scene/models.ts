// Robots and objects out of URDF files of the server, which asks for the token on each request.
import {
  BufferGeometry, BoxGeometry, Color, CylinderGeometry, Group, LoadingManager, Material, Mesh,
  MeshPhongMaterial, MeshStandardMaterial, Object3D, SphereGeometry,
} from 'three';
import {ColladaLoader} from 'three/examples/jsm/loaders/ColladaLoader.js';
import {STLLoader} from 'three/examples/jsm/loaders/STLLoader.js';
import URDFLoader, {URDFRobot} from 'urdf-loader';
import {ObjectSpec, RobotSpec} from '../protocol';
import {place} from './frames';
import {weld} from './weld';

async function fetchModel(url: string, token: string): Promise<Response> {
  const response = await fetch(url, {headers: {Authorization: `Bearer ${token}`}});
  if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
  return response;
}

// Lit alike everywhere, whatever lighting model a file asks for.
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

async function loadMesh(url: string, token: string, material: Material): Promise<Object3D> {
  const response = await fetchModel(url, token);
  if (/\.stl$/i.test(url)) {
    return new Mesh(new STLLoader().parse(await response.arrayBuffer()), material);
  }
  if (!/\.dae$/i.test(url)) throw new Error(`${url}: a mesh is .dae or .stl`);
  // URDF means the file's own axes, whatever they call up; so the loader is told that nothing is to
  // be turned (it would rotate Z-up files, and a rotated visual would be wrong by 90°).
  const text = (await response.text()).replace(/<up_axis>\s*[XZ]_UP\s*<\/up_axis>/,
                                               '<up_axis>Y_UP</up_axis>');
  const parsed = new ColladaLoader().parse(text, url.slice(0, url.lastIndexOf('/') + 1));
  if (!parsed) throw new Error(`${url}: not a Collada file`);
  // Lights and cameras of the modelling program are no part of the robot.
  const strays: Object3D[] = [];
  parsed.scene.traverse((node) => {
    if ('isLight' in node || 'isCamera' in node) strays.push(node);
  });
  strays.forEach((node) => node.removeFromParent());
  return parsed.scene;
}

// Cuts the links off with all that hangs on them.
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

// What a URDF describes, with its meshes. Throws an Error if a file is missing or not understood.
export async function loadUrdf(url: string, removed: string[], token: string): Promise<URDFRobot> {
  const text = await (await fetchModel(url, token)).text();
  const xml = new DOMParser().parseFromString(text, 'application/xml');
  if (xml.querySelector('parsererror')) throw new Error(`${url}: not well-formed`);
  removeLinks(xml, removed);
  const loader = new URDFLoader(new LoadingManager());
  loader.workingPath = url.slice(0, url.lastIndexOf('/') + 1);
  const meshes: Promise<void>[] = [];
  loader.loadMeshCb = (path, _manager, material, done) => {
    meshes.push(loadMesh(path, token, material).then((mesh) => done(mesh)));
  };
  const robot = loader.parse(xml);
  // What is shown is what was measured, also beyond a limit.
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

  async load(token: string): Promise<void> {
    this.robot = await loadUrdf(this.spec.urdf, this.spec.remove_links, token);
    this.group.add(this.robot);
  }

  // Joint positions in the order of spec.joints [rad].
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

// The object that is carried.
export async function loadObject(spec: ObjectSpec, token: string): Promise<Object3D> {
  if ('urdf' in spec) return loadUrdf(spec.urdf, [], token);
  const mesh = new Mesh(shapeGeometry(spec), new MeshStandardMaterial({color: 0xc29a6b}));
  finish(mesh);
  return mesh;
}

// Translucent, so that it does not compete with what it stands beside; only its nearest surface is
// seen, for its depth is drawn first.
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
