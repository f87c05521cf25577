// The program runs the paper's scene. The drawn links must have the poses of the program's own
// kinematics.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {
  asker, frames, launch, look, near, nearRotation, open, ready, screenshot, shows, until,
} from './harness.mjs';
import {fromPose, multiply, position, quaternion} from './panda.mjs';
import {Client, kRoundAndRound, linkPoses, Program} from './program.mjs';

const kScenario = 'box_9kg.yaml';
const kTolerance = 1e-3;  // [m], [rad]
const kLargestPage = 1e6;  // [bytes]

let program;
let browser;
let page;

before(async () => {
  browser = await launch();
  program = await Program.run(kScenario, {set: kRoundAndRound});
  page = await open(browser, program.url, {viewport: {width: 1280, height: 720}});
  await ready(page);
});

after(async () => {
  await browser?.close();
  await program?.end();
});

const predictor = asker(() => page);

// Returns the poses that one frame drew, and the state from which it drew them.
const drawn = (names) => page.evaluate((links) => {
  const {linkPose, shown} = window.predictor;
  return {state: shown(), poses: Object.fromEntries(links.map((name) => [name, linkPose(name)]))};
}, names);

async function compare(robot, prefix, joints) {
  const names = Object.keys(linkPoses(kScenario, robot, Array(7).fill(0)));
  assert.equal(names.length, 9, 'panda_link0 … panda_link8');
  const {state, poses} = await drawn(names.map((name) => prefix + name));
  const expected = linkPoses(kScenario, robot, joints(state).slice(0, 7));
  for (const name of names) {
    near(poses[prefix + name].p, expected[name].p, kTolerance, prefix + name);
    nearRotation(poses[prefix + name].q, expected[name].q, kTolerance, prefix + name);
  }
  return state;
}

test('the scene is drawn, and the page is small', async (t) => {
  assert.ok((await predictor('counters')).frames > 0);
  assert.ok((await predictor('triangles')) > 50_000, 'the cobot’s meshes are drawn');
  const firstMs = await predictor('firstRenderMs');
  t.diagnostic(`first frame ${firstMs.toFixed(0)} ms after the navigation began (latency_soak has a limit)`);
  const origin = new URL(program.url).origin;
  const sizes = await Promise.all(['/', '/app.js', '/app.css'].map(async (path) =>
    (await (await fetch(origin + path)).arrayBuffer()).byteLength));
  const total = sizes.reduce((a, b) => a + b);
  t.diagnostic(`the page has ${(total / 1000).toFixed(0)} kB`);
  assert.ok(total > 1e5 && total < kLargestPage);
});

test('every link of the cobot follows its joint angles', async () => {
  const first = await compare('cobot', '', (state) => state.cobotQ);
  await until(page, (p) => {
    const now = window.predictor.shown().object.p;
    return Math.hypot(...now.map((v, i) => v - p[i])) > 0.08;
  }, first.object.p);
  const later = await compare('cobot', '', (state) => state.cobotQ);
  assert.ok(later.cobotQ.some((q, i) => Math.abs(q - first.cobotQ[i]) > 0.05), 'it moved');
});

test('object and handles have the poses that the program sends', async () => {
  const client = await Client.join(program.url);
  const {handles} = client.welcome.scene;
  client.close();
  const {state, poses} = await drawn(['object', 'panda_link8', 'left:handle', 'right:handle']);
  near(poses.object.p, state.object.p, 1e-6, 'object');
  nearRotation(poses.object.q, state.object.q, kTolerance, 'object');
  near(poses.panda_link8.p, state.endEffector.p, kTolerance, 'end-effector');
  nearRotation(poses.panda_link8.q, state.endEffector.q, kTolerance, 'end-effector');
  for (const side of ['left', 'right']) {
    const X_WD = multiply(fromPose(state.object), fromPose(handles[side]));
    near(poses[`${side}:handle`].p, position(X_WD), kTolerance, `${side} handle`);
    nearRotation(poses[`${side}:handle`].q, quaternion(X_WD), kTolerance, `${side} handle`);
  }
});

test('the visuals lie on their links, so Z-up meshes are not rotated', async () => {
  const box = await page.evaluate(() => window.predictor.meshBox('panda_link0'));
  // The base of the Panda is 0.14 m high and stands on the floor. It is longer in x than in y.
  near([box.min[2], box.max[2]], [0, 0.14], 0.02, 'height of the base');
  assert.ok(box.max[0] - box.min[0] > box.max[1] - box.min[1]);
});

test('the instruction is that of the current action', async () => {
  const client = await Client.join(program.url);
  const {script} = client.welcome.scene;
  client.close();
  const {state, text} = await page.evaluate(() => ({
    state: window.predictor.shown(), text: window.predictor.instruction(),
  }));
  assert.equal(state.state, 'RUN');
  assert.equal(text, script[state.action].text);
});

test('left is left in texts and from the operator’s point of view', async () => {
  const client = await Client.join(program.url);
  const words = client.welcome.scene.script.at(-1).text;
  client.close();
  await look(page, 'operator');
  const {left, right, object, moved} = await page.evaluate(() => {
    const {project, shown} = window.predictor;
    const {hands, object: {p}} = shown();
    return {left: project(hands.left.virtual.p).x, right: project(hands.right.virtual.p).x,
            object: project(p).x, moved: project([p[0], p[1] + 0.3, p[2]]).x};
  });
  assert.ok(left < right, 'the left handle is on the left');
  assert.equal(words, `Move the object 30 cm to the ${moved < object ? 'left' : 'right'}.`);
  await look(page, 'free');
});

test('the real arms have the poses that follow from their joint angles', async () => {
  await page.click('#ghosts');
  await until(page, () => window.predictor.ghostsReady());
  await frames(page, 1);
  await compare('left', 'left:', (state) => state.hands.left.armQ);
  await compare('right', 'right:', (state) => state.hands.right.armQ);
  await screenshot(page, 'ghosts');
  await page.click('#ghosts');
});

test('the page fits a screen and a tablet, dark and light', async () => {
  for (const [width, height] of [[1280, 720], [1024, 768]]) {
    await page.setViewportSize({width, height});
    for (const theme of ['light', 'dark']) {
      if ((await predictor('theme')) !== theme) await page.click('#theme');
      await frames(page, 2);
      await shows(page, '#stop');
      await screenshot(page, `page-${width}-${theme}`);
    }
  }
});

test('no error was written to the console, and Ctrl-C ends the program', async () => {
  assert.deepEqual(page.problems, []);
  assert.equal(await program.end(), 0);
});
