// Checks the size and the memory of the report of a half-hour run. It prints the drawing times,
// which depend on the machine.
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {statSync} from 'node:fs';
import {join} from 'node:path';
import {test} from 'node:test';
import {binary, bring, open, own, root, until} from './files.mjs';

const its = own('report-soak');
const recording = join(its.folder, 'long.mcap');
const report = join(its.folder, 'long.html');
const soak = process.env.PREDICTOR_SOAK !== undefined;
const kCycles = soak ? 222 : 2;  // of 8 s
const kDuration = 8 * kCycles + 24;  // [s]
const kMemory = 1_000_000;           // limit of the process's memory [KiB]
const kZooms = 30;

test('the report needs less than 1 GB of memory and is smaller than 20 MB', () => {
  const script = `operator.script=[{action: grip, start: 0, duration: 0.5},
      {action: circle, start: 2, radius: 0.15, period: 8, cycles: ${kCycles}},
      {action: release, start: ${8 * kCycles + 14}}]`;
  const run = spawnSync(binary, ['simulate', join(root, 'scenarios/bar_circle.yaml'), '--quiet', '--set',
    `duration=${kDuration}`, '--set', script, '--record', recording], {encoding: 'utf8'});
  assert.equal(run.status, 0, run.stderr);
  const start = performance.now();
  const made = spawnSync('bash', ['-c', `ulimit -v ${kMemory}; exec "$0" "$@"`, binary, 'report', recording, '-o',
    report, '--quiet'], {encoding: 'utf8'});
  const seconds = (performance.now() - start) / 1000;
  assert.equal(made.status, 0, made.stderr);
  const size = statSync(report).size;
  console.log(`${kDuration} s in ${(statSync(recording).size / 1e6).toFixed(0)} MB: report after ${
    seconds.toFixed(1)} s, ${(size / 1e6).toFixed(1)} MB`);
  assert.ok(size < 20e6);
});

test('its plots zoom, and every step is drawn', async () => {
  const start = performance.now();
  const page = await open(its.browser, report, {viewport: {width: 1280, height: 720}});
  await bring(page, 'tracking');
  console.log(`shown after ${(performance.now() - start).toFixed(0)} ms`);
  await bring(page, 'forces');
  // The time from the turn of the wheel to the second frame after it is measured. By then, all
  // visible plots are drawn.
  await page.evaluate(() => {
    window.times = [];
    const frame = () => new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
    addEventListener('wheel', async () => {
      const before = performance.now();
      await frame();
      await frame();
      window.times.push(performance.now() - before);
    }, {capture: true, passive: true});
  });
  const zoom = async (delta) => {
    const box = await page.locator('#forces svg').boundingBox();
    await page.mouse.move(box.x + 0.4 * box.width, box.y + 90);
    await page.keyboard.down('Control');
    for (let k = 1; k <= kZooms; ++k) {
      await page.mouse.wheel(0, delta);
      await until(page, (n) => window.times.length >= n, k);
    }
    await page.keyboard.up('Control');
    return page.evaluate(() => window.times.splice(0));
  };
  const draws = await zoom(-120);
  assert.equal(await page.$eval('#forces .reset', (b) => b.disabled), false, 'it is zoomed');
  draws.push(...await zoom(120));
  await page.dblclick('#forces svg', {position: {x: 300, y: 90}});
  await until(page, () => document.querySelector('#forces .reset').disabled);
  draws.sort((a, b) => a - b);
  console.log(`a step of zooming takes ${draws[kZooms].toFixed(0)} ms (median), ${
    draws[Math.floor(1.9 * kZooms)].toFixed(0)} ms (95 %)`);
  assert.deepEqual(page.problems, []);
  await page.close();
});
