// Tests that the page draws the fixtures with the places and sizes in the scenario.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {launch, open, ready, screenshot, serve, shotsWanted} from './harness.mjs';

const kHalf = Math.SQRT1_2;
const color = [0.7, 0.5, 0.3];
const at = (p, q = [1, 0, 0, 0]) => ({p, q});
const kFixtures = [
  {shape: 'box', size: [0.4, 0.6, 0.04], pose: at([0.55, 0, 0.1]), color},
  // Its axis is along x.
  {shape: 'cylinder', size: [0.05, 0.3, 0], pose: at([0.3, 0.5, 0.2], [kHalf, 0, kHalf, 0]), color},
  {shape: 'capsule', size: [0.04, 0.2, 0], pose: at([0.3, -0.5, 0.14]), color: [0.2, 0.5, 0.8]},
  {shape: 'sphere', size: [0.06, 0, 0], pose: at([0.8, 0.4, 0.06]), color: [0.8, 0.2, 0.2]},
  {shape: 'plane', size: [0.5, 0.2, 0], pose: at([0.9, -0.4, 0.3]), color: [0.3, 0.6, 0.4]},
  {shape: 'box', size: [0.3, 0.3, 0.3], pose: at([0.9, 0.3, 0.8]), color, keep_out: true, name: 'head'},
];
const kObstacle = {...kFixtures[3], pose: at([0.7, 0.1, 0.5])};
// Half extents in W.
const kExtents = [[0.2, 0.3, 0.02], [0.15, 0.05, 0.05], [0.04, 0.04, 0.14], [0.06, 0.06, 0.06], [0.25, 0.1, 0],
  [0.15, 0.15, 0.15]];

let browser, server, page;

before(async () => {
  browser = await launch({unpainted: true});
  server = await serve({fixtures: kFixtures, light: !shotsWanted});
  page = await open(browser, server.url, {viewport: {width: 1280, height: 720}});
  await ready(page);
});

after(async () => {
  await browser?.close();
  await server?.close();
});

test('each fixture is drawn with its pose and size', async () => {
  const boxes = await page.evaluate(() => window.predictor.fixtureBoxes());
  assert.equal(boxes.length, kFixtures.length);
  boxes.forEach(({min, max}, i) => {
    for (let k = 0; k < 3; k++) {
      const middle = kFixtures[i].pose.p[k];
      assert.ok(Math.abs(min[k] - (middle - kExtents[i][k])) < 1e-3, `${kFixtures[i].shape}: ${min}`);
      assert.ok(Math.abs(max[k] - (middle + kExtents[i][k])) < 1e-3, `${kFixtures[i].shape}: ${max}`);
    }
  });
  await screenshot(page, 'fixtures');
});

test('only a keep-out volume is transparent', async () => {
  const boxes = await page.evaluate(() => window.predictor.fixtureBoxes());
  boxes.forEach(({opacity}, i) =>
    assert.equal(opacity < 1, kFixtures[i].keep_out === true, kFixtures[i].shape));
});

test('only a keep-out volume has a label, with its name, above it', async () => {
  const labels = () => page.evaluate(() => window.predictor.fixtureLabels());
  const [{text, p}, ...others] = await labels();
  assert.equal(text, 'keep-out volume: head');
  assert.deepEqual(others, []);
  const {p: middle} = kFixtures.at(-1).pose;
  for (const k of [0, 1]) assert.ok(Math.abs(p[k] - middle[k]) < 1e-3, `${p}`);
  assert.ok(p[2] > middle[2] + kExtents.at(-1)[2] && p[2] < middle[2] + kExtents.at(-1)[2] + 0.1, `${p}`);
});

test('the labels follow the fixtures', async () => {
  const texts = (expected) => page.waitForFunction(
      (all) => JSON.stringify(window.predictor.fixtureLabels().map(({text}) => text)) === all, JSON.stringify(expected));
  const {name, ...unnamed} = kFixtures.at(-1);
  server.broadcast({type: 'fixtures', fixtures: [unnamed]});
  await texts(['keep-out volume']);
  server.broadcast({type: 'fixtures', fixtures: kFixtures});
  await texts([`keep-out volume: ${name}`]);
});

test('a fixture of an event is drawn only while the event acts', async () => {
  const drawn = (count) => page.waitForFunction((n) => window.predictor.fixtureBoxes().length === n, count);
  await drawn(kFixtures.length);
  server.broadcast({type: 'fixtures', fixtures: [...kFixtures, kObstacle]});
  await drawn(kFixtures.length + 1);
  server.broadcast({type: 'fixtures', fixtures: kFixtures});
  await drawn(kFixtures.length);
});
