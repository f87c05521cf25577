// The report of half an hour: how large, how much memory, how smooth. How long depends on the
// machine, and is printed.
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {mkdtempSync, rmSync, statSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {after, before, test} from 'node:test';
import {fileURLToPath} from 'node:url';
import {launch} from '../../viewer/web/harness.mjs';

const root = join(dirname(fileURLToPath(import.meta.url)), '../../..');
const binary = process.env.PREDICTOR_BINARY ?? join(root, 'build/release/bin/predictor');
const folder = mkdtempSync(join(tmpdir(), 'predictor-report-soak-'));
const recording = join(folder, 'long.mcap');
const report = join(folder, 'long.html');
const soak = process.env.PREDICTOR_SOAK !== undefined;
const kCycles = soak ? 222 : 2;  // of 8 s
const kDuration = 8 * kCycles + 24;  // [s]
const kMemory = 1_000_000;           // of all that the process may ask for [KiB]
const kZooms = 30;
let browser;

before(async () => {
  browser = await launch();
});

after(async () => {
  await browser?.close();
  rmSync(folder, {recursive: true, force: true});
});

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
  const page = await browser.newPage({viewport: {width: 1280, height: 720}});
  const problems = [];
  page.setDefaultTimeout(240_000);
  page.on('pageerror', (error) => problems.push(String(error)));
  page.on('console', (m) => m.type() === 'error' && problems.push(m.text()));
  const start = performance.now();
  await page.goto(`file://${report}`);
  await page.waitForFunction(() => document.querySelector('figure.plot canvas'), null, {polling: 50});
  console.log(`shown after ${(performance.now() - start).toFixed(0)} ms`);
  await page.evaluate(() => document.getElementById('forces').scrollIntoView());
  await page.waitForFunction(() => document.querySelector('#forces canvas')?.width > 300, null, {polling: 50});
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
  await page.waitForFunction(() => document.querySelector('#forces .reset').disabled, null, {polling: 50});
  draws.sort((a, b) => a - b);
  console.log(`a step of zooming takes ${draws[kZooms].toFixed(0)} ms (median), ${
    draws[Math.floor(1.9 * kZooms)].toFixed(0)} ms (95 %)`);
  const zoomed = await page.$eval('#forces .reset', (b) => b.disabled);
  assert.equal(typeof zoomed, 'boolean');
  assert.deepEqual(problems, []);
  await page.close();
});
