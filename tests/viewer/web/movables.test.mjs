// The movable objects are drawn where the states say.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {launch, open, ready, screenshot, serve, shotsWanted} from './harness.mjs';

const kHalf = Math.SQRT1_2;
const kMovables = [
  {name: 'brick', shape: 'box', size: [0.3, 0.1, 0.06], color: [0.7, 0.3, 0.2],
    pose: {p: [0.6, -0.3, 0.2], q: [kHalf, 0, 0, kHalf]}},  // turned by 90° about z
  {name: 'can', shape: 'cylinder', size: [0.04, 0.12, 0], pose: {p: [0.5, 0.4, 0.3], q: [1, 0, 0, 0]}},
];
const kExtents = {brick: [0.05, 0.15, 0.03], can: [0.04, 0.04, 0.06]};  // half of them, in W

let browser, server, page;

before(async () => {
  browser = await launch({unpainted: true});
  server = await serve({movables: kMovables, light: !shotsWanted});
  page = await open(browser, server.url, {viewport: {width: 1280, height: 720}});
  await ready(page);
});

after(async () => {
  await browser?.close();
  await server?.close();
});

test('each movable object is drawn where it is, with its size', async () => {
  for (const {name, pose: {p}} of kMovables) {
    const {min, max} = await page.evaluate((of) => window.predictor.meshBox(of), `movable:${name}`);
    for (let k = 0; k < 3; k++) {
      assert.ok(Math.abs(min[k] - (p[k] - kExtents[name][k])) < 1e-3, `${name}: ${min}`);
      assert.ok(Math.abs(max[k] - (p[k] + kExtents[name][k])) < 1e-3, `${name}: ${max}`);
    }
  }
  await screenshot(page, 'movables');
});

test('a movable object follows the states', async () => {
  const moved = {p: [0.7, -0.2, 0.25], q: [1, 0, 0, 0]};
  server.options.movables = [{...kMovables[0], pose: moved}, kMovables[1]];
  await page.waitForFunction(
      ([x, y, z]) => {
        const {p} = window.predictor.linkPose('movable:brick');
        return Math.hypot(p[0] - x, p[1] - y, p[2] - z) < 1e-4;
      }, moved.p);
});
