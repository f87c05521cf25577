// Stops the program from the page, starts it again, and loses the connection to it.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {ready, screenshot, shows, take, until, waitFor} from './harness.mjs';
import {kRoundAndRound, Program} from './program.mjs';
import {Rig} from './rig.mjs';
import {capitalised, message} from './messages.mjs';

let page;
let client;
const rig = new Rig('box_9kg.yaml', {
  set: kRoundAndRound, unpainted: true, begun: () => ({page, client} = rig),
});
const {states, predictor} = rig;
const newest = () => rig.newest;
const ticks = (count) => rig.ticks(count);

const text = (id) => page.locator(id).textContent();

// Returns the speed of a real handle between two states [m/s].
function speed(a, b, side) {
  const way = Math.hypot(...[0, 1, 2].map((i) => b[`${side}_real`][i] - a[`${side}_real`][i]));
  return way / ((b.tick - a.tick) * 1e-3);
}

const lastSpeed = () => (states.length < 2 ? 0 : speed(states.at(-2), states.at(-1), 'left'));

const enabled = () => page.evaluate(() => ['align', 'start', 'reset'].filter(
    (id) => !document.getElementById(id).disabled));

// Presses a command's button once it is enabled, and waits for the state that follows.
async function command(button, title) {
  await page.click(`#${button}`);
  await until(page, (t) => window.predictor.stateText() === t, title);
}

// Repeats the request until it is granted, because hands must be free and everything must be at
// rest.
async function reset() {
  const idle = () => predictor('stateText').then((title) => title === 'Idle');
  await until(page, () => window.predictor.stateText() === 'Stopped, held');
  while (!(await idle())) {
    await page.evaluate(() => {
      const button = document.getElementById('reset');
      if (!button.disabled) button.click();
    });
    await page.waitForTimeout(300);
  }
}

test('the stop button brakes the arms and holds them', async () => {
  await waitFor(() => newest()?.state === 'RUN' && lastSpeed() > 0.02, 'a moving handle');
  await until(page, () => window.predictor.stateText() === 'Running');
  const from = states.length - 1;
  await page.click('#stop');
  await waitFor(() => newest().state === 'HELD', 'HELD');
  const way = [...new Set(states.slice(from).map((s) => s.state))];
  assert.deepEqual(way.filter((s) => s !== 'STOPPING'), ['RUN', 'HELD']);
  // After the stop, simulated time, the arms and the simulation must not move on.
  await ticks(300);
  const held = states.filter((s) => s.state === 'HELD');
  const [first, last] = [held.at(-10), held.at(-1)];
  for (const side of ['left', 'right']) {
    assert.ok(speed(first, last, side) < 1e-4, `${side}: ${speed(first, last, side)} m/s`);
    assert.deepEqual(last[`${side}_virtual`], held[0][`${side}_virtual`]);
  }
  assert.equal(last.run_time, held[0].run_time);
  assert.deepEqual(last.object, held[0].object);
});

test('the cause is shown in words', async () => {
  await until(page, () => window.predictor.stateText() === 'Stopped, held');
  assert.equal(await text('#cause'), `${capitalised('stop.operator.cause')}.`);
  assert.equal(await text('#advice'), `${message('stop.operator.advice')} ${message('next.reset')}`);
  await shows(page, '#cause');
  await shows(page, '#stop');
  await screenshot(page, 'stopped');
});

test('only a person with control can start the run again', async () => {
  const from = states.length;
  await ticks(1000);
  assert.deepEqual(await enabled(), []);
  client.send({type: 'command', command: 'reset'});
  await waitFor(() => client.denials.length > 0, 'a denial');
  await ticks(200);
  assert.ok(states.slice(from).every((s) => s.state === 'HELD'));
});

test('reset, align and start have their own buttons', async () => {
  await take(page, 'control');
  await until(page, () => !document.getElementById('reset').disabled);
  assert.deepEqual(await enabled(), ['reset']);
  await reset();
  await ticks(500);
  assert.equal(newest().state, 'IDLE');
  assert.equal(newest().run_time, 0);
  assert.equal(await text('#cause'), '');
  await command('align', 'Armed');
  await ticks(500);
  assert.equal(newest().state, 'ARMED');
  await page.focus('#start');
  await page.keyboard.press('Enter');
  await until(page, () => window.predictor.stateText() === 'Running');
  await waitFor(() => newest().run_time > 0.5, 'simulated time');
});

test('a client that may only look, admitted by a PIN, may stop the run', async () => {
  const other = await rig.open(new URL(rig.program.url).origin);
  await other.fill('#pin', await rig.program.pin('look'));
  await other.click('#pair');
  await ready(other);
  assert.equal(await other.evaluate(() => window.predictor.role()), 'look');
  assert.ok(await other.locator('#control-lease').isDisabled());
  await other.keyboard.press('Escape');
  await waitFor(() => newest().state === 'HELD', 'HELD');
  await until(page, (cause) => window.predictor.stopText().cause === cause,
              `${capitalised('stop.operator.cause')}.`);
  assert.deepEqual(other.problems, []);
  await other.context().close();
  // If a busy computer silenced the page for three seconds, the page no longer has the lease.
  if ((await predictor('leases')).control === null) await take(page, 'control');
  await reset();
  await command('align', 'Armed');
  await command('start', 'Running');
});

// Removes errors that the browser itself reports about an absent server.
const own = (problems) => problems.filter(
    (problem) => !/ERR_CONNECTION_REFUSED|WebSocket connection/.test(problem));

async function reportsTheLoss() {
  await until(page, () => !document.getElementById('emergency').hidden);
  assert.equal(await text('#emergency'), message('link.simulated.emergency'));
  await shows(page, '#stop', false);
  assert.equal(await predictor('instruction'), '');
}

test('the death of the viewer is reported, and nothing moves', async () => {
  assert.equal(newest().state, 'RUN');
  const {tick, run_time: runTime} = newest();
  const {program} = rig;
  const {url, viewerPid} = program;
  const reported = reportsTheLoss();
  const banner = until(page, () => !document.getElementById('banner').hidden);
  process.kill(viewerPid, 'SIGKILL');
  await Promise.all([reported, banner]);
  await screenshot(page, 'lost');
  await waitFor(() => program.viewerPid && program.viewerPid !== viewerPid, 'a new viewer');
  // The page's token is valid for the whole run, but its leases are free now.
  await until(page, () => window.predictor.phase() === 'open' && window.predictor.state());
  assert.deepEqual(await predictor('leases'), {type: 'leases', control: null, operator: null, clients: 1});
  const now = await predictor('state');
  assert.equal(now.state, 'RUN');
  assert.ok(now.tick > tick && now.runTime > runTime);
  assert.equal(program.url, url);
  await shows(page, '#stop');
  await shows(page, '#banner', false);
});

test('a run that hangs is reported while the viewer’s process is alive', async () => {
  assert.equal(await predictor('phase'), 'open');
  rig.program.freeze();
  await reportsTheLoss();
  await until(page, (title) => window.predictor.stateText() === title, message('link.silent.title'));
  assert.equal(await predictor('phase'), 'open');
  rig.program.thaw();
  await until(page, () => document.getElementById('emergency').hidden);
  await shows(page, '#stop');
});

test('another scenario can be chosen when idle, and only a person can start it', async () => {
  await take(page, 'control');
  assert.ok(await page.locator('#scenario').isDisabled());
  await page.click('#stop');
  await reset();
  const before = await predictor('state');
  await page.selectOption('#scenario', 'bar_circle');
  // The page, its address and its token must stay the same, but the scene must be a different one.
  await until(page, () => window.predictor?.ready() && /circle/i.test(window.predictor.scene()));
  await until(page, () => window.predictor.stateText() === 'Idle');
  assert.ok((await predictor('state')).tick < before.tick);
  assert.match(await page.locator('#scenario option:checked').textContent(), /circle/i);
  await page.waitForTimeout(1000);
  await until(page, () => window.predictor.stateText() === 'Idle');
  await take(page, 'control');
  await command('align', 'Armed');
  await command('start', 'Running');
  await page.click('#stop');
  await reset();
  await page.selectOption('#scenario', 'box_9kg');
  await until(page, () => window.predictor?.ready() && /box/i.test(window.predictor.scene()));
});

test('a restarted program replaces the old one on the page', async () => {
  const {port} = rig.program;
  assert.equal(await rig.program.end(), 0);
  await until(page, () => window.predictor.stateText() === 'Ended');
  rig.program = await Program.run('box_9kg.yaml', {...rig.settings, port});
  await page.goto(rig.program.url);    // in the same tab, without a reload
  await until(page, () => window.predictor.phase() === 'open' && window.predictor.state());
  const state = await predictor('state');
  assert.equal(state.stop.cause, 'none');
  assert.equal(await text('#cause'), '');
  assert.equal((await predictor('leases')).control, null);
  await shows(page, '#stop');
  await shows(page, '#emergency', false);
});

test('no error was written to the console', () => {
  assert.deepEqual(own(page.problems), []);
});
