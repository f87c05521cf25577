// The report of half an hour: how large, how much memory, how smooth. How long depends on the
// machine, and is printed.
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
const kMemory = 1_000_000;           // of all that the process may ask for [KiB]
const kZooms = 30;

test('it is made within 1 GB of memory and is smaller than 20 MB', () => {
  const script = `operator.script=[{action: grip, start: 0, duration: 0.5},
      {action: circle, start: 2, duration: ${8 * kCycles}, radius: 0.15, period: 8, cycles: ${kCycles}},
      {action: release, start: ${8 * kCycles + 14}, duration: 0.5}]`;
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

test('its plots zoom, each step drawn', async () => {
  const start = performance.now();
  const page = await open(its.browser, report, {viewport: {width: 1280, height: 720}});
  await until(page, () => document.querySelector('figure.plot canvas'));
  console.log(`shown after ${(performance.now() - start).toFixed(0)} ms`);
  await bring(page, 'forces');
  const zoom = (delta) => page.evaluate(async ([deltaY, zooms]) => {
    const frame = () => new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
    const canvas = document.querySelector('#forces canvas');
    const box = canvas.getBoundingClientRect();
    const times = [];
    for (let k = 0; k < zooms; ++k) {
      await frame();
      const before = performance.now();
      canvas.dispatchEvent(new WheelEvent('wheel', {deltaY, ctrlKey: true,
        clientX: box.left + 0.4 * box.width, clientY: box.top + 40, bubbles: true, cancelable: true}));
      await frame();
      times.push(performance.now() - before);
    }
    return times;
  }, [delta, kZooms]);
  const draws = await zoom(-120);
  assert.equal(await page.$eval('#forces .reset', (b) => b.disabled), false, 'it is zoomed');
  draws.push(...await zoom(120));
  await page.dblclick('#forces canvas', {position: {x: 300, y: 60}});
  await until(page, () => document.querySelector('#forces .reset').disabled);
  draws.sort((a, b) => a - b);
  console.log(`a step of zooming takes ${draws[kZooms].toFixed(0)} ms (median), ${
    draws[Math.floor(1.9 * kZooms)].toFixed(0)} ms (95 %)`);
  assert.deepEqual(page.problems, []);
  await page.close();
});
