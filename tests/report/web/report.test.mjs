// Opens a report as a file in Chromium. It must load nothing, and its plots must become
// interactive, zoom, and show values.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {join} from 'node:path';
import {before, test} from 'node:test';
import {screenshot} from '../../viewer/web/harness.mjs';
import * as files from './files.mjs';
import {drawn, own, predictor, root, until} from './files.mjs';
import {faults, printed} from './overlap.mjs';

const its = own('report');
const report = join(its.folder, 'push.html');

before(() => {
  const recording = join(its.folder, 'push.mcap');
  predictor('simulate', join(root, 'scenarios/push.yaml'), '--quiet', '--record', recording);
  predictor('report', recording, '-o', report, '--quiet');
});

const open = (colorScheme, options = {}) => files.open(its.browser, report, {colorScheme, ...options});

// Scrolls the plot into view and waits until it is painted.
async function bring(page, id) {
  await files.bring(page, id);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
}

for (const scheme of ['light', 'dark']) {
  test(`every plot is drawn, in ${scheme}, and nothing is fetched`, async () => {
    const page = await open(scheme);
    const ids = await page.$$eval('figure.plot', (all) => all.map((figure) => figure.id));
    assert.ok(ids.includes('stop-1') && ids.includes('tracking') && ids.includes('path-top'), ids.join());
    for (const id of ids) {
      await bring(page, id);
      let longest = 0, most = 0;
      for (let color = 0; color < 8; ++color) {
        const {lines, bars} = await drawn(page, id, `--c${color}`);
        for (const line of lines) assert.doesNotMatch(line, /NaN|undefined/, id);
        longest = Math.max(longest, ...lines.map((line) => line.length));
        most = Math.max(most, bars);
      }
      // The number of bars in the histogram of the computing time depends on the computer.
      assert.ok(longest > 20 || most > 0, `${id} shows neither a line (${longest}) nor a bar (${most})`);
    }
    await bring(page, 'stop-1');
    await screenshot(page, `report-${scheme}`);
    assert.deepEqual(page.problems, []);
    assert.deepEqual(page.asked, [`file://${report}`]);
    await page.close();
  });
}

test('a drag zooms all plots over time, the cursor shows values, the legend hides a line', async () => {
  const page = await open('light');
  await bring(page, 'forces');
  const box = await page.locator('#forces svg').boundingBox();
  const y = box.y + 90;
  await page.mouse.move(box.x + 0.6 * box.width, y);
  await until(page, () => Number(document.querySelector('#forces .tip .value')?.textContent.split(' ')[0]) > 10);
  assert.match(await page.locator('#forces .tip').innerText(), /Force, left\s+[\d.]+ N/);
  const {lines: before} = await drawn(page, 'forces', '--c0');
  await page.mouse.down();
  await page.mouse.move(box.x + 0.8 * box.width, y, {steps: 4});
  await page.mouse.up();
  await until(page, () => !document.querySelector('#forces .reset').disabled);
  const shown = async () => (await drawn(page, 'forces', '--c0')).lines;
  assert.ok(!(await shown()).some((line) => before.includes(line)), 'other lines are drawn');
  await bring(page, 'energy');
  assert.equal(await page.$eval('#energy .reset', (b) => b.disabled), false, 'zoomed together');
  await bring(page, 'forces');
  await page.dblclick('#forces svg', {position: {x: 300, y: 90}});
  await until(page, () => document.querySelector('#forces .reset').disabled);
  assert.ok((await shown()).sort().join() === before.sort().join(), 'the whole is as it was');
  await page.locator('#forces text', {hasText: /^left$/}).first().click();
  for (let k = 0; k < 600 && (await shown()).length === before.length; ++k) await page.waitForTimeout(100);
  const left = await shown();
  assert.equal(left.length, before.length - 1, 'a line is hidden');
  assert.ok(left.every((line) => before.includes(line)), 'and the others are as before');
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('keys zoom, move and reset the view', async () => {
  const page = await open('light');
  await bring(page, 'forces');
  await page.focus('#forces .live');
  const ends = () => page.$$eval('#forces text', (all) => all.map((t) => t.textContent).filter((t) => /^-?[\d.]+$/.test(t)).join());
  const whole = await ends();
  const seen = new Set([whole]);
  for (const key of ['+', '+', 'ArrowRight', '-']) {
    await page.keyboard.press(key);
    for (let k = 0; k < 600 && seen.has(await ends()); ++k) await page.waitForTimeout(100);
    assert.ok(!seen.has(await ends()), key);
    seen.add(await ends());
  }
  await page.keyboard.press('0');
  for (let k = 0; k < 600 && await ends() !== whole; ++k) await page.waitForTimeout(100);
  assert.equal(await ends(), whole);
  await page.close();
});

test('on paper the plots are drawn, white, and no words overlap', async () => {
  const page = await open('dark');
  await printed(page);
  assert.deepEqual(await faults(page), []);
  const ground = await page.$eval('body', (body) => getComputedStyle(body).backgroundColor);
  assert.equal(ground, 'rgb(255, 255, 255)', 'paper is white, also in the dark');
  assert.ok((await drawn(page, 'forces', '--c0')).lines.length > 0, 'in the colours of the light page');
  await screenshot(page, 'report-print');
  await page.close();
});

test('without scripts, the page reports that plots need them', async () => {
  const page = await open('light', {javaScriptEnabled: false});
  assert.match(await page.locator('noscript').first().innerText(), /plots need JavaScript/);
  await page.close();
});

test('a plot is saved as an SVG file, on white', async () => {
  const page = await open('dark');
  for (const id of ['stop-1', 'tracking', 'forces', 'joints', 'path-top', 'tick-histogram']) {
    await bring(page, id);
    const [download] = await Promise.all([page.waitForEvent('download'), page.click(`#${id} .save`)]);
    assert.equal(download.suggestedFilename(), `${id}.svg`);
    const svg = readFileSync(await download.path(), 'utf8');
    assert.ok(svg.startsWith('<svg') && svg.length > 2000, id);
    assert.match(svg, /<rect [^>]*fill="#fff"/, id);
    assert.doesNotMatch(svg, /NaN|undefined/, id);
  }
  await page.close();
});
