// A person pushes while the program runs. Each hand's arrow must turn green, orange and red, and
// red must be shown before the stop. The push rises slowly, so that a page on a slow computer also
// draws every colour. It is directed upwards, where the cobot resists.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {screenshot, shotsWanted, until} from './harness.mjs';
import {Rig} from './rig.mjs';
import {message} from './messages.mjs';

const kPush = (start, duration, force) =>
  `{action: push, start: ${start}, duration: ${duration}, force: [0, 0, ${force}], rise_time: 10}`;
// If the test takes screenshots, the arrow first stays red for a while.
const kScript = '[{action: grip, start: 0, duration: 0.5}, ' +
    (shotsWanted ? `${kPush(6, 30, 62)}, ${kPush(36, 20, 80)}]` : `${kPush(6, 40, 80)}]`);
const kThreshold = 30;  // [N]

let page;
const rig = new Rig('push.yaml', {
  set: ['duration=60', `operator.script=${kScript}`], unpainted: true, begun: () => ({page} = rig),
});
const {states, predictor} = rig;

const force = (state, side) => Math.hypot(...state[`${side}_wrench`].slice(0, 3));

// Returns the data of one frame: the colour of the drawn arrow and the force that it represents.
const seen = () => page.evaluate(() => {
  const {arrowColour, shown, stateText} = window.predictor;
  return ['left', 'right'].map((side) => ({
    state: stateText(), colour: arrowColour(side),
    force: Math.hypot(...shown().hands[side].wrench.slice(0, 3)),
  }));
});

test('arrows change colour at half and at 80 % of the threshold, and are red before the stop', async () => {
  const samples = [];
  const shots = new Set();
  await until(page, () => window.predictor.stateText() === 'Running');
  for (let stopped = false; !stopped;) {
    const now = await seen();
    samples.push(...now);
    stopped = now[0].state !== 'Running';
    const colour = now.some((s) => s.colour === 'red') ? 'red' : now[0].colour;
    if (!shots.has(colour) && now[0].force > 8) {
      await screenshot(page, `arrows-${colour}`);
      shots.add(colour);
    }
    await page.waitForTimeout(50);
  }
  const running = samples.filter((s) => s.state === 'Running');
  for (const {colour, force: f} of running) {
    // The force rises. The colour may therefore belong to the displayed force or, with sensor
    // noise, to a slightly larger one.
    const colours = [f, f + 2, f + 4].map((it) => it / kThreshold)
                        .map((part) => (part < 0.5 ? 'green' : part <= 0.8 ? 'orange' : 'red'));
    assert.ok(colours.includes(colour), `${f} N: ${colour}`);
  }
  assert.deepEqual([...new Set(running.map((s) => s.colour))].sort(), ['green', 'orange', 'red']);
});

test('the force causes the stop, which is shown with hand, value and limit', async () => {
  await rig.reach('HELD');
  await until(page, () => window.predictor.stateText() === 'Stopped, held');
  const {cause} = await predictor('stopText');
  const [, hand, value] = cause.match(
      new RegExp(`^(Left|Right) hand: ${message('stop.force.cause')} \\((\\d+\\.\\d+) N, limit 30\\.0+ N\\)\\.$`)) ?? [];
  assert.ok(hand, cause);
  assert.ok(Number(value) >= kThreshold && Number(value) < kThreshold + 5, cause);
  assert.equal(['Left', 'Right'][states.at(-1).cause_hand], hand);
  await screenshot(page, 'stopped-by-force');
  // No earlier state may exceed the threshold. Then the page has shown the run's own values.
  const last = states.findLast((s) => s.state === 'RUN');
  assert.ok(Math.max(force(last, 'left'), force(last, 'right')) <= kThreshold + 0.5);
});

test('no error was written to the console, and a stopped run ends with 1', async () => {
  assert.deepEqual(page.problems, []);
  assert.equal(await rig.program.end(), 1);
});
