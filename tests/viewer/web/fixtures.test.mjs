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
];
// They appear with the scenario's second event, and with its first or third.
const kObstacles = [0b010, 0b101].map((events) => ({...kFixtures[3], events}));
// Half extents in W.
const kExtents = [[0.2, 0.3, 0.02], [0.15, 0.05, 0.05], [0.04, 0.04, 0.14], [0.06, 0.06, 0.06], [0.25, 0.1, 0]];

let browser, server, page;

before(async () => {
  browser = await launch({unpainted: true});
  server = await serve({fixtures: [...kFixtures, ...kObstacles], events: 0b100, light: !shotsWanted});
  page = await open(browser, server.url, {viewport: {width: 1280, height: 720}});
  await ready(page);
});

after(async () => {
  await browser?.close();
  await server?.close();
});

test('each fixture is drawn with its pose and size', async () => {
  const boxes = (await page.evaluate(() => window.predictor.fixtureBoxes())).slice(0, kFixtures.length);
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

test('a fixture of an event is drawn only while the event acts', async () => {
  await page.waitForFunction((count) => window.predictor.fixtureBoxes().length === count, kFixtures.length + 1);
});
