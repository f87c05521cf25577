// A server that implements docs/reference/viewer-protocol.md and plays a made-up run, so that the
// page can be developed and tested without the program. Run as a command, it serves until Ctrl-C.
import {readFile, readdir} from 'node:fs/promises';
import {createServer} from 'node:http';
import {createRequire} from 'node:module';
import {randomBytes} from 'node:crypto';
import {dirname, join} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';
import {
  kArmHandle, kArmPosture, kAttachment, kPosture, kScenes, pandaSpec,
} from './fake_scenes.mjs';
import {personMessage} from './fake_person.mjs';
import {kCauses, kHandFields, kRunFields, kStates} from './names.mjs';
import {
  fromPose, inverse, links, multiply, pose, position, quaternion, reach, transform,
} from './panda.mjs';

const root = join(dirname(fileURLToPath(import.meta.url)), '../../..');
const {WebSocketServer} = createRequire(join(root, 'web/package.json'))('ws');
const kModels = join(root, '.deps/prefix/cmeel.prefix/share/example-robot-data/robots');
const kPanda = join(kModels, 'panda_description');

export {kCauses, kStates};
const kQuantityOf = {force: 2, torque: 3, oscillation: 2, coupling: 2, tracking: 4, elbow: 4,
                     joint: 5, stale: 8, qp: 1, deadline: 1};
const kParameterNames = ['stiffness_translation', 'stiffness_rotation', 'damping_ratio', 'force',
                         'torque'];
const kSides = ['left', 'right'];

const kFields = [
  ...kRunFields,
  ...kSides.flatMap((side) => kHandFields.map(([n, t, c]) => [`${side}_${n}`, t, c])),
];
const kSizes = {u8: 1, i8: 1, u16: 2, i32: 4, u32: 4, u64: 8, f32: 4, f64: 8};
export const kFrame = [];
let frameBytes = 0;
for (const [name, type, count] of kFields) {
  kFrame.push({name, offset: frameBytes, type, count});
  frameBytes += kSizes[type] * count;
}

function encode(values) {
  const view = new DataView(new ArrayBuffer(frameBytes));
  const write = {
    u8: (o, v) => view.setUint8(o, v), i8: (o, v) => view.setInt8(o, v),
    u16: (o, v) => view.setUint16(o, v, true),
    i32: (o, v) => view.setInt32(o, v, true),
    u64: (o, v) => view.setBigUint64(o, BigInt(Math.round(v)), true),
    f32: (o, v) => view.setFloat32(o, v, true), f64: (o, v) => view.setFloat64(o, v, true),
  };
  for (const {name, offset, type, count} of kFrame) {
    const list = Array.isArray(values[name]) ? values[name] : [values[name] ?? 0];
    for (let i = 0; i < count; i++) write[type](offset + i * kSizes[type], list[i] ?? 0);
  }
  return Buffer.from(view.buffer);
}

const now = () => Number(process.hrtime.bigint());
const bearer = (request) => (request.headers.authorization ?? '').replace('Bearer ', '');

export class FakeServer {
  // The options are `scene` ('box' | 'circle'), `operator`, `simulated`, `state`, `table` and
  // `light`. `object` contains the files of the object's model {name: text}, which must include
  // model.urdf. `ground` is where the operator stands in W. `person` is the reason why the person
  // is not judged. An `older` server sends no data about the person. `movables`
  // are movable objects, each with its `pose`.
  constructor(options = {}) {
    this.options = {scene: 'box', operator: 'virtual', simulated: true, state: 'RUN', ground: [1, 0, 0], ...options};
    this.preset = kScenes[this.options.scene];
    this.received = [];    // every message of every page
    this.hands = {left: null, right: null};
    this.force = null;     // {left: [6], right: [6]}: replaces the made-up wrenches
    this.frozen = false;   // stops the run time, for comparisons
    this.sending = true;
    this.deaf = false;     // ignores stops
    this.full = false;     // refuses another page
    this.file = 'made_up'; // the scenario's file
    this.personStatus = 'judged';
    this.personHead = 'modelled';  // origin of the person's head
    this.personInputs = {};  // what streams measure: heart_rate, and [status, last] of the others
    this.liftRange = 0.4;  // largest load of the lower back as a share of the range of LiFFT
    this.sendingPerson = true;
    this.parameters = [1, 1, 1, 30, 5];
    this.targets = [...this.parameters];
    this.state = this.options.state;
    this.cause = {cause: 'none', hand: -1, value: 0, limit: 0};
    this.recording = true;
    this.results = null;   // the run's results, once it has ended
    this.planned = [];     // the events, of which only the experimenter's page may learn
    this.runTime = 0;
    this.tick = 0;
    this.offset = [0, 0, 0];
    this.cobotQ = kPosture;
    this.armQ = {left: kArmPosture, right: kArmPosture};
    this.pins = {'493027': 'control', '111111': 'look', '222222': 'operator'};
    const start = links(kPosture)[7];
    const joint = multiply(start, kAttachment);
    const on = this.preset.onObject;
    this.start = position(joint).map((v, i) => v - on[i]);
    this.renew();
  }

  // Becomes a new process with a different identity and code. It accepts no earlier token.
  renew() {
    this.server = randomBytes(8).toString('hex');
    this.code = randomBytes(12).toString('base64url');
    this.tokens = new Map();
    this.nextClient = 1;
    this.leases = {control: null, operator: null};
  }

  async listen(port = 0) {
    this.http = createServer((request, response) => this.serve(request, response));
    this.sockets = new WebSocketServer({
      server: this.http, path: '/ws',
      handleProtocols: (offered) => (offered.has('predictor.v1') ? 'predictor.v1' : false),
    });
    this.sockets.on('connection', (socket) => this.connected(socket));
    await new Promise((resolve) => this.http.listen(port, '127.0.0.1', resolve));
    this.port = this.http.address().port;
    this.last = now();
    this.timer = setInterval(() => this.step(), 1000 / 60);
    return this;
  }

  get origin() {
    return `http://127.0.0.1:${this.port}`;
  }

  get url() {
    return `${this.origin}/#code=${this.code}`;
  }

  async close() {
    clearInterval(this.timer);
    for (const socket of this.sockets.clients) socket.terminate();
    this.sockets.close();
    this.http.closeAllConnections();
    await new Promise((resolve) => this.http.close(resolve));
  }

  get scene() {
    const {preset, options} = this;
    const handle = (side) => {
      const [x, y, z] = preset.handle;
      return pose(transform([x, side === 'left' ? y : -y, z]));
    };
    const arm = (side, model) =>
      ({...pandaSpec(model, preset.bases[side]), handle: pose(kArmHandle)});
    const factor = {min: 0.1, max: 2, value: 1};
    return {
      name: preset.name, file: this.file, mode: 'emulate', simulated: options.simulated,
      duration: options.operator === 'browser' ? 0 : preset.duration, ...(this.results && {results: this.results}),
      operator: options.operator, rate: 1000,
      viewpoint: {eye: [this.start[0] + 0.62, this.start[1], this.start[2] + 0.55], forward: [-1, 0, 0], guess: false, ground: options.ground, feet: 0.3},
      cobot: pandaSpec(0, [0, 0, 0]),
      object: preset.object, handles: {left: handle('left'), right: handle('right')},
      arms: {left: arm('left', 2), right: arm('right', 3)}, floor: true,
      table: options.table ?? null,
      ...(!options.older && {fixtures: options.fixtures ?? []}),
      ...(!options.older && {movables: (options.movables ?? []).map(({pose: _, ...spec}) => spec)}),
      guidance: preset.guidance ? {
        type: 'circle', radius: preset.guidance.radius,
        center: this.start.map((v, i) => v + preset.guidance.offset[i]),
      } : {type: 'none', center: [0, 0, 0], radius: 0},
      thresholds: {force: 30, torque: 5, tracking: 0.05, security_distance: 0.3,
                   influence_distance: 0.7},
      parameters: {stiffness_translation: factor, stiffness_rotation: factor,
                   damping_ratio: {min: 0.1, max: 3, value: 1},
                   force: {min: 5, max: 30, value: 30}, torque: {min: 1, max: 5, value: 5}},
      script: preset.script.map(([action, start, duration, text]) =>
        ({action, start, duration, hand: 'both', text})),
      ...(!options.older && {acting: []}),
      ...(!options.older && {person: options.person ? {judged: false, why: options.person} : {judged: true}}),
      scenarios: ['made_up', 'made_up_too'].map((name) => ({name, title: preset.name})),
    };
  }

  // ---- HTTP --------------------------------------------------------------------------------------

  async serve(request, response) {
    const path = request.url.split('?')[0];
    const page = {'/': ['index.html', 'text/html'], '/experimenter': ['index.html', 'text/html'], '/app.js': ['app.js', 'text/javascript'],
                  '/app.css': ['app.css', 'text/css']}[path];
    response.setHeader('Content-Security-Policy',
                       "default-src 'none'; script-src 'self'; style-src 'self'; " +
                           "connect-src 'self'; img-src 'self' data: blob:; " +
                           "base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
    response.setHeader('Referrer-Policy', 'no-referrer');
    response.setHeader('X-Frame-Options', 'DENY');
    response.setHeader('X-Content-Type-Options', 'nosniff');
    response.setHeader('Cross-Origin-Opener-Policy', 'same-origin');
    try {
      if (page) {
        response.setHeader('Content-Type', `${page[1]}; charset=utf-8`);
        response.end(await readFile(join(root, 'web/dist', page[0])));
        return;
      }
      if (path === this.results?.report && this.tokens.has(bearer(request))) {
        response.end('<!doctype html><title>Report</title>');
        return;
      }
      if (!this.tokens.has(bearer(request))) {
        response.writeHead(401).end();
        return;
      }
      response.end(await this.model(path));
    } catch {
      response.writeHead(404).end();
    }
  }

  async model(path) {
    const [, , number, file] = path.split('/');
    if (number === '1' && this.options.object) {
      if (!(file in this.options.object)) throw new Error(file);
      return this.options.object[file];
    }
    if (number === '1') return readFile(join(root, 'assets', this.preset.file));
    const meshes = (await readdir(join(kPanda, 'meshes/visual'))).sort();
    const mesh = /^(\d+)\.dae$/.exec(file);
    if (mesh) return readFile(join(kPanda, 'meshes/visual', meshes[Number(mesh[1])]));
    if (this.options.light) return this.lightModel();
    const urdf = await readFile(join(kPanda, 'urdf/panda.urdf'), 'utf8');
    return urdf.replace(/"package:[^"]*\/visual\/([^"]*)"/g,
                        (_all, name) => `"${meshes.indexOf(name)}.dae"`);
  }

  // Returns a model of cylinders and spheres for machines that draw slowly. It uses the collision
  // bodies as visuals.
  async lightModel() {
    const urdf = await readFile(join(kPanda, 'urdf/panda_collision.urdf'), 'utf8');
    return urdf.replace(/<visual>[^]*?<\/visual>/g, '').replaceAll('collision>', 'visual>');
  }

  // ---- WebSocket ---------------------------------------------------------------------------------

  connected(socket) {
    socket.on('message', (data, binary) => {
      if (binary) return socket.close(1003, 'not understood');
      const message = JSON.parse(data.toString());
      this.received.push({...message, client: socket.client});
      if (socket.client === undefined && message.type !== 'hello') return socket.close(1008);
      this.take(socket, message);
    });
    socket.on('close', () => this.left(socket));
  }

  send(socket, message) {
    socket.send(JSON.stringify(message));
  }

  broadcast(message, except = null) {
    for (const socket of this.sockets.clients) {
      if (socket.client !== undefined && socket !== except) this.send(socket, message);
    }
  }

  admit(socket, message) {
    if (this.full) return socket.close(1013, 'There is no room for another page.');
    let role = null;
    if (message.code === this.code) role = 'control';
    if (message.pin) role = this.pins[message.pin] ?? null;
    if (message.token) role = this.tokens.get(message.token) ?? null;
    if (!role) {
      this.send(socket, {type: 'refused', reason: message.pin ?
        'These digits are not valid (any more).' : 'This tab is not known here: type the digits.'});
      return socket.close(1008, 'refused');
    }
    const token = message.token ?? randomBytes(32).toString('base64url');
    this.tokens.set(token, role);
    socket.client = this.nextClient++;
    socket.role = role;
    this.send(socket, {
      type: 'welcome', client: socket.client, role, token, server: this.server, server_ns: now(),
      leases: this.leaseMessage(), scene: this.scene, frame: kFrame, features: this.options.older ? ['headset'] : ['headset', 'person'],
    });
    this.broadcast({type: 'leases', ...this.leaseMessage()});
  }

  leaseMessage() {
    const clients = [...this.sockets.clients].filter((s) => s.client !== undefined).length;
    return {...this.leases, clients};
  }

  left(socket) {
    if (socket.client === undefined) return;
    const client = socket.client;
    socket.client = undefined;
    for (const what of ['control', 'operator']) {
      if (this.leases[what] === client) this.leases[what] = null;
    }
    this.broadcast({type: 'leases', ...this.leaseMessage()});
  }

  take(socket, message) {
    const denied = (reason) => this.send(socket, {type: 'denied', what: message.type, reason});
    switch (message.type) {
      case 'hello': return this.admit(socket, message);
      case 'ping':
        return this.send(socket, {type: 'pong', page_ms: message.page_ms, server_ns: now()});
      case 'stop': return this.deaf ? undefined : this.stop('operator', -1, 0, 0);
      case 'lease': return this.lease(socket, message, denied);
      case 'experimenter':
        if (socket.role !== 'control') return denied('This role may not see the events to come.');
        return this.send(socket, {type: 'events', complete: true, events: this.planned});
      case 'immersive':
        if (message.p) {
          this.broadcast({type: 'headset', client: socket.client, active: message.active,
                          p: message.p, q: message.q}, socket);
        }
        return;
      case 'command':
        if (this.leases.control !== socket.client) return denied('Take control first.');
        return this.command(message.command);
      case 'scenario':
        if (this.leases.control !== socket.client) return denied('Take control first.');
        this.chosen = message.name;
        return;
      case 'parameter':
        if (this.leases.control !== socket.client) return denied('Take control first.');
        this.targets[kParameterNames.indexOf(message.parameter)] = message.value;
        return;
      case 'hand':
        if (this.leases.operator !== socket.client) return denied('Take the operator’s lease first.');
        this.hands[message.hand] = message.grip ? {...message, at: now()} : null;
    }
  }

  lease(socket, {what, take}, denied) {
    if (take && socket.role === 'look') return denied('This page may only look.');
    if (take && this.leases[what] !== null && this.leases[what] !== socket.client) {
      return denied('Another page has it.');
    }
    if (!take && this.leases[what] !== socket.client) return;
    this.leases[what] = take ? socket.client : null;
    this.broadcast({type: 'leases', ...this.leaseMessage()});
  }

  command(command) {
    if (command === 'align' && this.state === 'IDLE') {
      this.state = 'ALIGN';
      setTimeout(() => this.state === 'ALIGN' && (this.state = 'ARMED'), 400);
    } else if (command === 'start' && this.state === 'ARMED') {
      this.state = 'RUN';
    } else if (command === 'end' && this.state === 'RUN') {
      this.state = 'HELD';
    } else if (command === 'reset' && ['HELD', 'UNPOWERED'].includes(this.state)) {
      this.state = 'IDLE';
      this.cause = {cause: 'none', hand: -1, value: 0, limit: 0};
      this.runTime = 0;
    }
  }

  // Ends the run. `results` is a server with these results that replaces this one, or null.
  async finish(how, results = null) {
    this.state = 'HELD';
    this.recording = false;
    this.broadcast({type: 'ended', text: how, results_follow: results !== null});
    for (const socket of this.sockets.clients) socket.close(1001, 'The run has ended.');
    const {port} = this;
    this.server = randomBytes(8).toString('hex');
    this.leases = {control: null, operator: null};
    this.results = results && {how, ...results};
    await this.close();
    if (results) await this.listen(port);
  }

  stop(cause, hand, value, limit) {
    if (['STOPPING', 'HELD', 'UNPOWERED'].includes(this.state)) return;
    this.cause = {cause, hand, value, limit};
    this.state = 'STOPPING';
    setTimeout(() => this.state === 'STOPPING' && (this.state = 'HELD'), 250);
  }

  // ---- invented run
  // ------------------------------------------------------------------------------

  step() {
    const time = now();
    const dt = (time - this.last) / 1e9;
    this.last = time;
    this.tick += Math.max(1, Math.round(dt * 1000));
    if (this.state === 'RUN' && !this.frozen) this.advance(dt);
    this.parameters = this.parameters.map((v, i) => v + (this.targets[i] - v) * Math.min(1, 6 * dt));
    if (!this.sending) return;
    const values = this.values(time);
    for (const socket of this.sockets.clients) {
      if (socket.client === undefined || socket.bufferedAmount > 0) continue;
      socket.send(encode({...values, sent_ns: now()}));
    }
    this.sendPerson();
  }

  sendPerson() {
    if (this.options.person || this.options.older || !this.sendingPerson) return;
    const hands = Object.fromEntries(kSides.map((side) => [side, position(this.handlePose(side))]));
    const wrenches = Object.fromEntries(kSides.map((side) => [side, this.wrench(side)]));
    this.broadcast(personMessage(this.scene, this.runTime, this.tick, hands, wrenches, this.personStatus,
                                 this.personHead, this.liftRange, this.personInputs));
  }

  advance(dt) {
    this.runTime += dt;
    if (this.options.operator !== 'browser') {
      this.offset = this.preset.path(this.runTime % this.preset.duration);
      return;
    }
    for (const side of kSides) {
      if (this.hands[side] && now() - this.hands[side].at > 250e6) this.hands[side] = null;
    }
    const pulls = kSides.filter((side) => this.hands[side]).map((side) =>
      this.hands[side].p.map((v, i) => v - position(this.handlePose(side))[i]));
    for (const pull of pulls) {
      this.offset = this.offset.map((v, i) => v + pull[i] * Math.min(1, 2 * dt));
    }
  }

  objectPose() {
    return transform(this.start.map((v, i) => v + this.offset[i]));
  }

  handlePose(side) {
    return multiply(this.objectPose(), fromPose(this.scene.handles[side]));
  }

  // Returns the largest force and torque. The made-up run changes slowly, so the newest values are
  // the largest.
  peak(side) {
    const wrench = this.wrench(side);
    return [Math.hypot(...wrench.slice(0, 3)), Math.hypot(...wrench.slice(3))];
  }

  wrench(side) {
    if (this.force) return this.force[side];
    if (this.options.operator === 'browser') {
      const hand = this.hands[side];
      if (!hand) return [0, 0, 0, 0, 0, 0];
      const at = position(this.handlePose(side));
      const pull = hand.p.map((v, i) => 250 * (v - at[i]));
      const scale = Math.min(1, 25 / Math.max(Math.hypot(...pull), 1e-9));
      return [...pull.map((v) => v * scale), 0, 0, 0];
    }
    const t = this.runTime + (side === 'left' ? 0 : 0.4);
    return [3 * Math.sin(t), 4 * Math.sin(0.7 * t), 11 + 7 * Math.sin(0.5 * t),
            0.8 * Math.sin(0.9 * t), 1.2 * Math.cos(0.6 * t), 0.5 * Math.sin(t)];
  }

  values(time) {
    const object = this.objectPose();
    const attach = multiply(object, transform(this.preset.onObject));
    this.cobotQ = reach(multiply(attach, inverse(kAttachment)), this.cobotQ);
    const flange = links(this.cobotQ)[7];
    const seven = (m) => [...position(m), ...quaternion(m)];
    const {cause, hand, value, limit} = this.cause;
    const script = this.preset.script;
    const action = script.findLastIndex(([, start]) => start <= this.runTime);
    const values = {
      tick: this.tick, run_time: this.runTime, wall_ns: time, state: kStates.indexOf(this.state),
      cause: kCauses.indexOf(cause), cause_hand: hand, cause_quantity: kQuantityOf[cause] ?? 0,
      cause_value: value, cause_limit: limit,
      harder_cause: 0, harder_cause_hand: -1, harder_cause_quantity: 0, harder_cause_value: 0,
      harder_cause_limit: 0, action: this.state === 'RUN' ? action : -1,
      events: this.options.events ?? 0, latest_event: 0, cobot_stop: 0, attachment: this.options.attachment ?? 0,
      cobot_q: this.cobotQ, object: seven(object), end_effector: seven(flange),
      movables: (this.options.movables ?? []).flatMap(({pose: {p, q}}) => [...p, ...q]),
      link_distance: 0.47 + 0.05 * Math.sin(this.runTime), relative_slack: [0, 0, 0, 0, 0, 0],
      stage_us: [0.4, 0.3, 5.5, 4.2, 0.3, 0.2, 0.3, 11 + 1.2 * Math.sin(time / 3e8)],
      parameters: this.parameters, recording: this.recording ? 1 : 0,
    };
    for (const side of kSides) {
      const virtual = this.handlePose(side);
      const sway = 6e-4 * (1 + Math.sin(1.7 * this.runTime + (side === 'left' ? 0 : 1)));
      const real = multiply(transform([0, 0, -sway]), virtual);
      const base = transform(this.preset.bases[side]);
      this.armQ[side] = reach(multiply(real, inverse(kArmHandle)), this.armQ[side], base);
      Object.assign(values, {
        [`${side}_present`]: 1,
        [`${side}_gripping`]: this.options.operator === 'browser' ? (this.hands[side] ? 1 : 0) :
                                                                    this.state === 'RUN' ? 1 : 0,
        [`${side}_real`]: seven(real), [`${side}_virtual`]: seven(virtual),
        [`${side}_wrench`]: this.wrench(side), [`${side}_peak`]: this.peak(side), [`${side}_coupling`]: [0, 0, 0, 0, 0, 0],
        [`${side}_arm_q`]: this.armQ[side], [`${side}_manipulability`]: 0.09,
        [`${side}_sensor_age`]: 0.0012,
      });
    }
    return values;
  }
}

if (import.meta.url === pathToFileURL(process.argv[1] ?? '').href) {
  const options = Object.fromEntries(process.argv.slice(2).map((a) => a.split('=')));
  const server = await new FakeServer(options).listen(Number(options.port ?? 8081));
  console.log(server.url);
}
