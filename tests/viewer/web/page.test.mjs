// Tests the page in Chromium: scene, panel, plots and mouse. The tests check states, but never
// frame rates or times that depend on the machine.
import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {after, before, test} from 'node:test';
import {
  asker, launch, look, near, nearRotation, open, ready, screenshot, serve, shotsWanted,
  take, until, waitFor, waitForText,
} from './harness.mjs';
import {links, pose} from './panda.mjs';
import {capitalised, message} from './messages.mjs';

let browser;
let server;
let page;

before(async () => {
  browser = await launch({unpainted: true});
  server = await serve({light: !shotsWanted});
  page = await open(browser, server.url);
  await ready(page);
});

after(async () => {
  await browser?.close();
  await server?.close();
});

const predictor = asker(() => page);

function level(value, threshold) {
  const ratio = value / threshold;
  return ratio < 0.5 ? 'green' : ratio <= 0.8 ? 'orange' : 'red';
}

// ---- scene ---------------------------------------------------------------------------------------

test('the drawn links have the poses that follow from the joint angles', async () => {
  const seen = await page.evaluate(() => {
    const {linkPose, shown} = window.predictor;
    const names = [1, 2, 3, 4, 5, 6, 7, 8].map((i) => `panda_link${i}`);
    return {q: shown().cobotQ, poses: names.map((name) => linkPose(name)),
            object: linkPose('object'), reported: shown().object, end: shown().endEffector};
  });
  links(seen.q).map(pose).forEach(({p, q}, i) => {
    near(seen.poses[i].p, p, 1e-4, `panda_link${i + 1}`);
    nearRotation(seen.poses[i].q, q, 1e-3, `panda_link${i + 1}`);
  });
  near(seen.object.p, seen.reported.p, 1e-6, 'object');
  near(seen.poses[7].p, seen.end.p, 1e-3, 'end-effector');
});

test('removed links are neither shown nor requested', async () => {
  assert.equal(await predictor('linkPose', 'panda_hand'), null);
  assert.equal(await predictor('linkPose', 'panda_leftfinger'), null);
});

test('the real arms appear on demand, with the poses that follow from their joints', async () => {
  await page.click('#ghosts');
  await until(page, () => window.predictor.ghostsReady());
  const frames = (await predictor('counters')).frames;
  await until(page, (n) => window.predictor.counters().frames > n + 1, frames);
  const seen = await page.evaluate(() => ({
    q: window.predictor.shown().hands.left.armQ, base: window.predictor.linkPose('left:panda_link0'),
    end: window.predictor.linkPose('left:panda_link8'),
  }));
  const m = links(seen.q)[7];
  const expected = pose(m).p.map((v, i) => v + seen.base.p[i]);  // the bases are not rotated
  near(seen.end.p, expected, 1e-4, 'left arm');
  await screenshot(page, 'ghosts');
  await page.click('#ghosts');
});

test('camera presets move the camera, by button and by key', async () => {
  const eyes = new Set();
  for (const view of ['front', 'side', 'top', 'operator', 'free']) {
    await look(page, view);
    eyes.add((await predictor('cameraPosition')).map((v) => v.toFixed(1)).join());
    if (view !== 'free') await screenshot(page, `view-${view}`);
  }
  assert.equal(eyes.size, 5);
  await page.keyboard.press('4');
  await until(page, () => window.predictor.view() === 'top');
  await page.keyboard.press('1');
});

// ---- arrows, guidance, instruction ---------------------------------------------------------------

test('arrows have the colour of their share of the current threshold', async () => {
  const read = () => page.evaluate(() => ({
    force: window.predictor.arrowColour('left'), torque: window.predictor.arrowColour('left', 'torque'),
    wrench: window.predictor.shown().hands.left.wrench, limits: window.predictor.shown().parameters,
  }));
  const expected = ({wrench, limits}) => ({
    force: level(Math.hypot(...wrench.slice(0, 3)), limits[3]), torque: level(Math.hypot(...wrench.slice(3)), limits[4]),
  });
  // The colours are those of the last drawn frame, which may be older than the values.
  const check = async () => {
    let seen = await read();
    const agree = () => seen.force === expected(seen).force && seen.torque === expected(seen).torque;
    for (let k = 0; k < 200 && !agree(); ++k) {
      await page.waitForTimeout(50);
      seen = await read();
    }
    assert.deepEqual({force: seen.force, torque: seen.torque}, expected(seen));
  };
  await check();
  for (const [force, color] of [[14, 'green'], [20, 'orange'], [26, 'red']]) {
    server.force = {left: [0, 0, force, 0, force / 6, 0], right: [force / 4, 0, force / 2, 0, 0, 1]};
    await until(page, (f) => Math.abs(window.predictor.shown().hands.left.wrench[2] - f) < 0.01, force);
    await until(page, (c) => window.predictor.arrowColour('left') === c, color);
    await check();
    assert.equal(await predictor('arrowVisible', 'left'), true);
    await screenshot(page, `arrows-${color}`);
  }
  // At a threshold of 30 N, 26 N must be red. A lower threshold makes 14 N orange.
  server.force = {left: [0, 0, 14, 0, 0, 0], right: [0, 0, 0, 0, 0, 0]};
  server.targets[3] = 20;
  await until(page, () => window.predictor.arrowColour('left') === 'orange');
  await until(page, () => !window.predictor.arrowVisible('right'));
  server.targets[3] = 30;
  server.force = null;
});

test('the instruction of the current action is shown during the run', async () => {
  const text = await page.evaluate(() => window.predictor.instruction());
  assert.ok(server.scene.script.some((action) => action.text === text), text);
});

// ---- panel ---------------------------------------------------------------------------------------

test('commands need the lease and the right state', async () => {
  const enabled = () => page.evaluate(() => ['align', 'start', 'reset'].filter(
      (id) => !document.getElementById(id).disabled));
  assert.deepEqual(await enabled(), []);
  await take(page, 'control');
  assert.deepEqual(await enabled(), []);  // RUN
  await page.click('#stop');
  await until(page, () => window.predictor.stateText() === 'Stopped, held');
  assert.deepEqual(await enabled(), ['reset']);
  assert.match((await predictor('stopText')).cause, new RegExp(capitalised('stop.operator.cause')));
  await page.click('#reset');
  await until(page, () => window.predictor.stateText() === 'Idle');
  assert.deepEqual(await enabled(), ['align']);
  await page.click('#align');
  await until(page, () => window.predictor.stateText() === 'Armed');
  assert.deepEqual(await enabled(), ['start']);
  await page.focus('#start');
  await page.keyboard.press('Enter');
  await until(page, () => window.predictor.stateText() === 'Running');
});

test('a stop is shown with hand, value and limit', async () => {
  for (const [cause, value, limit, words] of [
    ['force', 31.24, 30, `${message('hand.left', {text: message('stop.force.cause')})} (31.2 N, limit 30.0 N).`],
    ['force', 30.04, 30, `${message('hand.left', {text: message('stop.force.cause')})} (30.04 N, limit 30.00 N).`],
    ['tracking', 0.0512, 0.05, '(51.2 mm, limit 50.0 mm)'],
    ['joint', 0.5236, 0.4, '(30.0°, limit 22.9°)'],
    ['stale', 0.006, 0.005, '(6.0 ms, limit 5.0 ms)'],
  ]) {
    server.stop(cause, 0, value, limit);
    await until(page, (w) => window.predictor.stopText().cause.includes(w), words);
    assert.ok((await predictor('stopText')).advice.length > 10);
    await until(page, () => window.predictor.stateText() === 'Stopped, held');
    if (cause === 'force') await screenshot(page, 'stopped');
    server.command('reset');
    server.state = 'RUN';
    await until(page, () => window.predictor.stopText().cause === '');
  }
});

test('Space and Esc stop the run from anywhere and press no button', async () => {
  for (const [focus, key] of [['#theme', 'Space'], ['#window-30', 'Escape'], ['canvas', 'Space'],
                              ['#parameter-damping_ratio', 'Space']]) {
    server.state = 'RUN';
    server.cause = {cause: 'none', hand: -1, value: 0, limit: 0};
    await until(page, () => window.predictor.stateText() === 'Running');
    const theme = await predictor('theme');
    const range = await predictor('plotRange');
    await page.focus(focus);
    const stops = server.received.filter((m) => m.type === 'stop').length;
    await page.keyboard.press(key);
    await until(page, () => window.predictor.stateText() === 'Stopped, held');
    assert.equal(server.received.filter((m) => m.type === 'stop').length, stops + 1);
    assert.equal(await predictor('theme'), theme);
    assert.equal((await predictor('plotRange'))[0].toFixed(0), range[0].toFixed(0));
  }
  server.command('reset');
  server.state = 'RUN';
});

test('the state of the grip is shown once it has changed', async () => {
  const grip = page.locator('#grip');
  assert.ok(await grip.isHidden());
  for (const [attachment, words] of [[2, /The gripper is open\./], [1, /The gripper slips\./],
                                     [3, /too far away/], [0, /The gripper holds the object\./]]) {
    server.options.attachment = attachment;
    await waitForText(grip, words);
    assert.ok(await grip.isVisible());
  }
});

test('a slider requests a value and shows the value of the run', async () => {
  await page.locator('#parameter-stiffness_translation').fill('0.5');
  await waitFor(() => Math.abs(server.targets[0] - 0.5) < 0.02, 'the parameter message');
  await until(page, () => Math.abs(window.predictor.state().parameters[0] - 0.5) < 0.02);
  const output = page.locator('output[for="parameter-stiffness_translation"]');
  await waitForText(output, /0\.5\d? ×|0\.50 ×/);
  await page.focus('#parameter-force');
  await page.keyboard.press('ArrowLeft');
  await waitFor(() => server.targets[3] < 30, 'an arrow key');
  server.targets = [1, 1, 1, 30, 5];
});

test('plots pause, zoom by dragging and change their window', async () => {
  await until(page, () => window.predictor.counters().points > 20);
  await page.click('#window-60');
  assert.ok(Math.abs((await predictor('plotRange'))[0] + 60) < 0.01);
  await page.click('#window-10');
  await page.click('#plots-pause');
  const points = (await predictor('counters')).points;
  const states = (await predictor('counters')).states;
  await until(page, (n) => window.predictor.counters().states > n + 10, states);
  assert.equal((await predictor('counters')).points, points);
  await page.click('#plots-pause');
  await until(page, (n) => window.predictor.counters().points > n + 10, points);
  const box = await page.locator('#plot-forces .u-over').boundingBox();
  await page.mouse.move(box.x + box.width * 0.5, box.y + 20);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.8, box.y + 20, {steps: 4});
  await page.mouse.up();
  assert.equal(await predictor('plotsPaused'), true);
  const [from, to] = await predictor('plotRange');
  assert.ok(to - from < 4 && to - from > 1, `${from} … ${to}`);
  await page.click('#plots-pause');
  assert.equal(await predictor('plotsPaused'), false);
});

// Parses the table of the plots. Returns columns by name, with rows of numbers (or '').
function parseTable(text) {
  const [head, ...rows] = text.trim().split('\n').map((line) => line.split(','));
  return {head, column: (name) => rows.map((row) => row[head.findIndex((h) => h.startsWith(`${name} `))])};
}

test('a paused plot shows the values under the cursor', async () => {
  server.force = {left: [0, 0, 12, 0, 0, 3], right: [0, 0, 0, 0, 0, 0]};
  await until(page, () => Math.abs(window.predictor.shown().hands.left.wrench[2] - 12) < 0.01);
  await page.waitForTimeout(400);
  await page.click('#plots-pause');
  server.force.left = [0, 0, 20, 0, 0, 3];
  const box = await page.locator('#plot-forces .u-over').boundingBox();
  await page.mouse.move(box.x + box.width - 2, box.y + 20);
  await waitForText(page.locator('#plots-cursor'), /^at -?0\.\d\d s$/);
  const values = await page.locator('#plot-forces .legend .value').allTextContents();
  assert.equal(values[0], '12.0');
  assert.equal(values[2], '30.0', 'the limit too');
  await page.mouse.move(10, 10);
  await waitForText(page.locator('#plots-cursor'), /drag to zoom/);
  await page.click('#plots-pause');
});

test('a button shows torque and rotation with their thresholds', async () => {
  const value = (id, i) => page.locator(`#plot-${id} .legend .value`).nth(i).textContent();
  assert.equal(await page.locator('#plot-torques').isVisible(), false);
  await page.click('#show-torques');
  assert.ok(await page.locator('#plot-torques').isVisible());
  assert.equal(await page.locator('#plot-forces').isVisible(), false);
  await waitForText(page.locator('#plot-torques .legend .value').first(), /^3\.00$/);
  assert.equal(await value('torques', 2), '5.00');
  await page.click('#show-rotation');
  assert.ok(await page.locator('#plot-rotation').isVisible());
  const {virtual, real} = (await predictor('shown')).hands.left;
  const dot = Math.min(1, Math.abs(virtual.q.reduce((sum, v, i) => sum + v * real.q[i], 0)));
  assert.ok(Math.abs(Number(await value('rotation', 0)) - (360 / Math.PI) * Math.acos(dot)) < 0.05);
  await screenshot(page, 'plots-torque-rotation');
  await page.click('#show-tracking');
  assert.equal(await value('tracking', 2), '50.00');
  await page.click('#show-forces');
  await until(page, () => Math.abs(window.predictor.shown().hands.left.wrench[2] - 20) < 0.01);
  const {points} = await predictor('counters');
  await until(page, (n) => window.predictor.counters().points > n + 3, points);
});

test('plots are saved as a table and as a picture, and the scene as a picture', async () => {
  const {head, column} = parseTable(await predictor('plotTable'));
  assert.equal(head[0], 'time [s]');
  const [times, forces] = [column('time').map(Number), column('left_force').map(Number)];
  assert.ok(times.length > 20 && times[0] >= -10.01 && times.at(-1) === 0);
  assert.ok(times.every((t, i) => i === 0 || t > times[i - 1]));
  assert.ok(Math.abs(forces.at(-1) - 20) < 0.1, `${forces.at(-1)} N now`);
  assert.ok(column('force_limit').every((v) => v === '' || (Number(v) >= 5 && Number(v) < 30.1)));
  for (const [button, name, least] of [['save-table', 'plots.csv', 1000], ['save-plots', 'plots.png', 2000],
                                       ['save-picture', 'scene.png', 5000]]) {
    await page.evaluate((it) => (window.painted = it), name === 'scene.png');
    const [download] = await Promise.all([page.waitForEvent('download'), page.click(`#${button}`)]);
    assert.ok(download.suggestedFilename().endsWith(name));
    const bytes = await readFile(await download.path());
    assert.ok(bytes.length > least, `${name}: ${bytes.length} bytes`);
    if (name.endsWith('png')) assert.equal(bytes.toString('latin1', 1, 4), 'PNG');
  }
  await page.evaluate(() => (window.painted = false));
  server.force = null;
});

test('the progress of the script is shown', async () => {
  server.runTime = 15;
  // The test compares the text with the displayed state, whenever it is drawn.
  await until(page, (duration) => {
    const {runTime} = window.predictor.shown();
    const part = Number(document.getElementById('progress').getAttribute('aria-valuenow'));
    return runTime >= 15 && Math.abs(part - 100 * Math.min(runTime / duration, 1)) <= 2;
  }, server.scene.duration);
  assert.equal(await page.locator('#progress b').count(), server.scene.script.length);
});

test('recording is shown', async () => {
  await until(page, () => !document.getElementById('recording').hidden);
  server.recording = false;
  await until(page, () => document.getElementById('recording').hidden);
  server.recording = true;
});

test('everything that can be pressed has a name and can be reached by Tab', async () => {
  const unnamed = await page.evaluate(() => [...document.querySelectorAll('button, input')].filter(
      (e) => !(e.getAttribute('aria-label') || e.textContent.trim() || e.labels?.length)).length);
  assert.equal(unnamed, 0);
  const reached = new Set();
  await page.focus('#theme');
  for (let i = 0; i < 60; i++) {
    await page.keyboard.press('Tab');
    reached.add(await page.evaluate(() => document.activeElement?.id ?? ''));
  }
  for (const id of ['stop', 'plots-pause', 'window-30', 'view-front', 'ghosts']) {
    assert.ok(reached.has(id), id);
  }
});

test('the page has a dark and a light colour scheme', async () => {
  const theme = await predictor('theme');
  await page.click('#theme');
  assert.notEqual(await predictor('theme'), theme);
  await screenshot(page, 'light');
  await page.click('#theme');
});

test('stop is visible on a screen of 1280 × 720 and on a tablet', async () => {
  for (const [width, height] of [[1280, 720], [1024, 768]]) {
    await page.setViewportSize({width, height});
    const box = await page.locator('#stop').boundingBox();
    assert.ok(box.x >= 0 && box.y >= 0 && box.x + box.width <= width && box.y + box.height <= height);
    assert.ok(box.width * box.height > 10_000);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= width, 'nothing sticks out');
    // Every slider must be visible without scrolling.
    for (const name of ['stiffness_translation', 'damping_ratio', 'force', 'torque']) {
      const slider = await page.locator(`#parameter-${name}`).boundingBox();
      assert.ok(slider.y + slider.height <= height && slider.x + slider.width <= width, name);
    }
    await screenshot(page, `page-${width}`);
  }
});

test('messages of the run stay until they are dismissed', async () => {
  server.broadcast({type: 'notice', text: 'The force threshold stays at 20 N.'});
  await waitForText(page.locator('#warning'), /stays at 20 N/);
  await page.click('#warning button');
  assert.equal(await page.locator('#warning').isVisible(), false);
});

test('no error was written to the console', () => {
  assert.deepEqual(page.problems, []);
});
