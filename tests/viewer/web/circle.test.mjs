// Tests the circle to follow, the table, and a page in a light colour scheme.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {asker, launch, open, ready, screenshot, serve, shotsWanted, until} from './harness.mjs';

let browser;
let server;
let page;

before(async () => {
  browser = await launch({unpainted: true});
  server = await serve({scene: 'circle', light: !shotsWanted,
                        table: {size: [0.5, 1, 0.04], top: [0.55, 0, 0.12]}});
  page = await open(browser, server.url, {scheme: 'light', viewport: {width: 1280, height: 720}});
  await ready(page);
});

after(async () => {
  await browser?.close();
  await server?.close();
});

const predictor = asker(() => page);

test('the error is the distance of the object from the circle', async () => {
  const {center, radius} = server.scene.guidance;
  const seen = await page.evaluate(() => ({
    error: window.predictor.guidanceError(), p: window.predictor.shown().object.p,
  }));
  const [x, y, z] = seen.p.map((v, i) => v - center[i]);
  const expected = Math.hypot(Math.hypot(x, y) - radius, z);
  assert.ok(Math.abs(seen.error - expected) < 1e-6, `${seen.error}, not ${expected}`);
  assert.match(await page.locator('#guidance').textContent(), /^Off the path: \d+ mm$/);
  assert.ok(await page.locator('#guidance').isVisible());
});

test('the page shows the error in millimetres', async () => {
  server.frozen = true;
  const {center, radius} = server.scene.guidance;
  const onCircle = center.map((v, i) => v + (i === 1 ? radius + 0.023 : 0));
  server.offset = onCircle.map((v, i) => v - server.start[i]);
  await until(page, () => document.getElementById('guidance').textContent === 'Off the path: 23 mm');
  server.frozen = false;
});

test('the trail grows along the path and starts again after a jump', async () => {
  const {trail} = await predictor('counters');
  await until(page, (n) => window.predictor.counters().trail > n + 20, trail);
  if (shotsWanted) await page.waitForTimeout(5000);
  await screenshot(page, 'circle');
  const long = (await predictor('counters')).trail;
  server.frozen = true;
  server.offset = [0, 0, 0.5];
  await until(page, (n) => window.predictor.counters().trail < n, long);
  server.frozen = false;
});

test('each second is marked on the trail', async () => {
  const {trailMarks} = await predictor('counters');
  await until(page, (n) => window.predictor.counters().trailMarks > n + 1, trailMarks);
  const {trail, trailMarks: marks} = await predictor('counters');
  assert.ok(marks < trail / 3, `${marks} marks, ${trail} points`);
});

test('after the circle, its mean error and largest error are shown', async () => {
  assert.equal(await page.locator('#score').isVisible(), false);
  server.offset = [0, 0, 0];
  server.runTime = 28;
  await until(page, () => !document.getElementById('score').hidden);
  const text = await page.locator('#score').textContent();
  const [, mean, largest] = text.match(/average (\d+\.\d) mm, at most (\d+\.\d) mm$/).map(Number);
  // The deviation is 8 mm · sin 3a radially and 2 mm · sin 5a vertically. That is 5.3 mm on average
  // and never more than 8.3 mm.
  assert.ok(mean > 4 && mean < 6.5, text);
  assert.ok(largest > 7 && largest < 8.4, text);
  await screenshot(page, 'circle-score');
});

test('the page uses the system’s light colour scheme, and keeps a chosen one', async () => {
  assert.equal(await predictor('theme'), 'light');
  await page.click('#theme');
  await page.reload();
  await until(page, () => window.predictor?.phase() === 'open');
  assert.equal(await predictor('theme'), 'dark');
  assert.deepEqual(page.problems, []);
});

test('nothing is loaded but the page’s files and the models', async (t) => {
  await ready(page);
  t.diagnostic(`first render after ${(await predictor('firstRenderMs')).toFixed(0)} ms`);
  const paths = await page.evaluate(() => performance.getEntriesByType('resource').map(
      (entry) => new URL(entry.name).pathname));
  const foreign = paths.filter((path) => !/^\/(app\.js|app\.css|models\/\d+\/[\w.]+)?$/.test(path));
  assert.deepEqual(foreign, []);
});
