// Runs `predictor run` at a separate terminal, because a run without a terminal ends with its
// script. PREDICTOR_BINARY names the program. `link_poses` (tests/viewer/web/link_poses.cpp) is in
// the same folder.
import assert from 'node:assert/strict';
import {spawn, spawnSync} from 'node:child_process';
import {existsSync, mkdirSync, readdirSync, readFileSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {waitFor, web} from './harness.mjs';
import {kStates} from './names.mjs';

const {WebSocket} = createRequire(join(web, 'package.json'))('ws');
const root = join(dirname(fileURLToPath(import.meta.url)), '../../..');
const binary = process.env.PREDICTOR_BINARY ?? join(root, 'build/release/bin/predictor');
const linkPosesBinary = process.env.PREDICTOR_LINK_POSES ?? join(dirname(binary), 'link_poses');
const kPandaFolder = join(
    root, '.deps/prefix/cmeel.prefix/share/example-robot-data/robots/panda_description/urdf');
const kLightFolder = join(tmpdir(), `predictor-web-${process.pid}`);
const kEndMs = 20_000;

export {kStates};

const quote = (word) => `'${word.replaceAll("'", `'\\''`)}'`;
const pathOf = (scenario) => join(root, 'scenarios', scenario);

export class Program {
  // Runs scenarios/SCENARIO. Options: set (['path.to.key=value']), port (0: any), args, terminal.
  static async run(scenario, {set = [], port = 0, args = [], terminal = true} = {}) {
    assert.ok(existsSync(binary), `${binary} does not exist. Build it, or set PREDICTOR_BINARY.`);
    return new Program().serve([
      binary, 'run', pathOf(scenario), '--quiet', '--port', String(port),
      ...(args.includes('--record') ? [] : ['--no-record']), ...args,
      ...set.flatMap((s) => ['--set', s]),
    ], terminal);
  }

  // Replays a recording in the viewer.
  static replay(file) {
    return new Program().serve([binary, 'replay', file, '--port', '0']);
  }

  // Starts the program and waits until it serves a page.
  async serve(words, terminal = true) {
    this.start(words, terminal);
    await waitFor(() => this.url || this.code !== null, 'the printed address');
    assert.ok(this.url, `the program ended: ${this.output}`);
    return this;
  }

  start(words, terminal = true) {
    this.output = '';
    this.code = null;
    this.terminal = terminal;
    const env = {...process.env, SHELL: '/bin/sh', PREDICTOR_PACKAGE_PATH: kLightFolder};
    this.child = terminal ?
      spawn('script', ['-qfec', `exec ${words.map(quote).join(' ')}`, '/dev/null'],
            {env, stdio: ['pipe', 'pipe', 'inherit']}) :
      spawn(words[0], words.slice(1), {env, stdio: ['ignore', 'pipe', 'pipe']});
    this.child.stdout.on('data', (text) => (this.output += text));
    this.child.stderr?.on('data', (text) => (this.output += text));
    this.ended = new Promise((resolve) => this.child.on('close', (code) => {
      this.code = code;
      resolve(code);
    }));
  }

  // The address that was printed last. The address changes when the viewer's process restarts.
  get url() {
    return this.output.match(/Viewer: (\S+)/g)?.at(-1).slice(8) ?? null;
  }

  get port() {
    return Number(new URL(this.url).port);
  }

  get pid() {
    return this.terminal ? children(this.child.pid)[0] : this.child.pid;
  }

  get viewerPid() {
    return children(this.pid).find((pid) =>
      readFileSync(`/proc/${pid}/cmdline`, 'utf8').includes('viewer-process')) ?? null;
  }

  type(line) {
    this.child.stdin.write(`${line}\n`);
  }

  // A six-digit PIN for a role, as the console prints it.
  async pin(role) {
    const from = this.output.length;
    const digits = () => this.output.slice(from).match(/Pin (\d{6}) /)?.[1];
    this.type(`pin ${role}`);
    await waitFor(digits, 'six digits');
    return digits();
  }

  // Stops the process as a debugger would. (`script`, which holds the terminal, then stops itself
  // too.)
  freeze() {
    process.kill(this.pid, 'SIGSTOP');
  }

  thaw() {
    this.child.kill('SIGCONT');
    process.kill(this.pid, 'SIGCONT');
  }

  // Ends the program with Ctrl-C and returns its exit code. Kills it if it does not end, so that it
  // does not outlive its test.
  async end() {
    if (this.code === null) {
      if (this.terminal) this.child.stdin.write('\x03');
      else this.child.kill('SIGINT');
    }
    const timer = setTimeout(() => {
      for (const pid of children(this.child.pid)) process.kill(pid, 'SIGKILL');
      this.child.kill('SIGKILL');
    }, kEndMs);
    const code = await this.ended;
    clearTimeout(timer);
    return code;
  }
}

// Records a run in virtual time to `file`.
export function record(scenario, file, set = []) {
  const {status, stderr} = spawnSync(
      binary, ['simulate', pathOf(scenario), '--quiet', '--record', file,
               ...set.flatMap((s) => ['--set', s])],
      {encoding: 'utf8', env: {...process.env, PREDICTOR_PACKAGE_PATH: kLightFolder}});
  assert.ok(status === 0 || status === 1, stderr);
}

// Returns the channels of a recording as rows of numbers.
export function channels(file, names) {
  const {status, stdout, stderr} = spawnSync(
      binary, ['export', 'data', file, ...names, '--quiet'], {encoding: 'utf8', maxBuffer: 1 << 28});
  assert.equal(status, 0, stderr);
  return stdout.trim().split('\n').slice(1).map((line) => line.split(',').map(Number));
}

// Settings that make the virtual operator move the object in circles for an hour, because a test
// may start late.
export const kRoundAndRound = [
  'duration=3600',
  'operator.script=[{action: grip, start: 0, duration: 0.5}, ' +
      '{action: circle, start: 1, radius: 0.08, period: 8, cycles: 400}, ' +
      '{action: move, start: 3300, duration: 4, by: [0, 0.3, 0]}]',
];

// A setting that shows the cobot as its collision bodies, which are cylinders and spheres, for
// computers without a graphics card. Joints, masses and inertias are the same.
export function lightCobot() {
  const urdf = readFileSync(join(kPandaFolder, 'panda_collision.urdf'), 'utf8');
  mkdirSync(kLightFolder, {recursive: true});
  const file = join(kLightFolder, 'panda.urdf');
  const seen = (collision) => collision + collision.replaceAll('collision>', 'visual>');
  writeFileSync(file, urdf.replace(/<visual>[^]*?<\/visual>/g, '')
                          .replace(/<collision>[^]*?<\/collision>/g, seen));
  return `cobot.model=${file}`;
}

function children(pid) {
  return readdirSync(`/proc/${pid}/task`).flatMap((task) =>
    readFileSync(`/proc/${pid}/task/${task}/children`, 'utf8').split(' ').filter(Boolean).map(Number));
}

// Poses of a robot's links in W, computed with the program's own kinematics, {link: {p, q}}. robot:
// 'cobot', or 'left' or 'right' of the scenario.
export function linkPoses(scenario, robot, q) {
  const {status, stdout, stderr} = spawnSync(
      linkPosesBinary, [pathOf(scenario), robot, ...q.map(String)],
      {encoding: 'utf8'});
  assert.equal(status, 0, stderr);
  return Object.fromEntries(stdout.trim().split('\n').map((line) => {
    const [name, ...numbers] = line.split(' ');
    const n = numbers.map(Number);
    return [name, {p: n.slice(0, 3), q: n.slice(3)}];
  }));
}

// A client without a page. The code of an address admits it; it stores the messages that it reads.
export class Client {
  static async join(url) {
    const {host, origin, hash} = new URL(url);
    const client = new Client();
    client.messages = [];
    client.states = 0;
    const socket = new WebSocket(`ws://${host}/ws`, 'predictor.v1', {origin});
    client.socket = socket;
    socket.on('message', (data, binary) => {
      if (binary) {
        client.states++;
        client.onState?.(client.decode(data));
        return;
      }
      client.messages.push(JSON.parse(data.toString()));
    });
    socket.on('close', (code, reason) => (client.closed = {code, reason: reason.toString()}));
    socket.on('open', () => socket.send(JSON.stringify({type: 'hello', code: hash.slice(6)})));
    await waitFor(() => client.welcome || client.closed, 'a welcome');
    assert.ok(client.welcome, JSON.stringify(client.messages));
    client.heart = setInterval(() => client.send({type: 'heartbeat'}), 1000);
    return client;
  }

  get denials() {
    return this.messages.filter((m) => m.type === 'denied');
  }

  get welcome() {
    return this.messages.find((m) => m.type === 'welcome');
  }

  send(message) {
    if (this.closed) return;
    this.socket.send(JSON.stringify(message));
  }

  // Decodes those fields of a state that the tests need.
  decode(data) {
    const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
    const read = {
      u8: (o) => view.getUint8(o), i8: (o) => view.getInt8(o), u16: (o) => view.getUint16(o, true),
      i32: (o) => view.getInt32(o, true),
      u64: (o) => Number(view.getBigUint64(o, true)), f32: (o) => view.getFloat32(o, true),
      f64: (o) => view.getFloat64(o, true),
    };
    const sizes = {u8: 1, i8: 1, u16: 2, i32: 4, u64: 8, f32: 4, f64: 8};
    return Object.fromEntries(this.welcome.frame.map(({name, offset, type, count}) => {
      const list = Array.from({length: count}, (_, i) => read[type](offset + i * sizes[type]));
      return [name, count === 1 ? list[0] : list];
    }));
  }

  close() {
    clearInterval(this.heart);
    this.socket.terminate();
  }
}
