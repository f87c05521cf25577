// A report in Chromium, opened as a file: nothing is fetched, plots come alive, zoom and tell values.
import assert from 'node:assert/strict';
import {statSync} from 'node:fs';
import {join} from 'node:path';
import {before, test} from 'node:test';
import {screenshot} from '../../viewer/web/harness.mjs';
import * as files from './files.mjs';
import {own, predictor, root, until} from './files.mjs';
import {faults} from './overlap.mjs';

const its = own('report');
const report = join(its.folder, 'push.html');
const svgs = join(its.folder, 'svg');
const kFlat = ['slack'];  // nothing was given up: its line lies in the frame

before(() => {
  const recording = join(its.folder, 'push.mcap');
  predictor('simulate', join(root, 'scenarios/push.yaml'), '--quiet', '--record', recording);
  predictor('report', recording, '-o', report, '--svg', svgs, '--quiet');
});

const open = (colorScheme, options = {}) => files.open(its.browser, report, {colorScheme, ...options});

// Into view, and painted.
async function bring(page, id) {
  await files.bring(page, id);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
}

// Pixels of a plot's first panel that are nearly of a colour of the page's style.
function painted(page, id, variable, tolerance = 12) {
  return page.evaluate(([name, color, most]) => {
    const canvas = document.querySelector(`#${name} canvas`);
    const probe = document.createElement('canvas').getContext('2d');
    probe.fillStyle = getComputedStyle(document.documentElement).getPropertyValue(color).trim();
    probe.fillRect(0, 0, 1, 1);
    const [r, g, b] = probe.getImageData(0, 0, 1, 1).data;
    const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) {
      if (Math.abs(data[i] - r) + Math.abs(data[i + 1] - g) + Math.abs(data[i + 2] - b) < most &&
          data[i + 3] > 200) ++count;
    }
    return count;
  }, [id, variable, tolerance]);
}

for (const scheme of ['light', 'dark']) {
  test(`every plot is drawn, in ${scheme}, and nothing is fetched`, async () => {
    const page = await open(scheme);
    const ids = await page.$$eval('figure.plot', (all) => all.map((figure) => figure.id));
    assert.ok(ids.includes('stop-1') && ids.includes('tracking') && ids.includes('path-top'), ids.join());
    for (const id of ids) {
      await bring(page, id);
      const colors = await page.$$eval(`#${id} .panel:first-child .key`, (all) => all.map(
          (key) => key.style.getPropertyValue('--series').slice(4, -1)));
      let most = 0;  // lines may lie on one another
      for (const color of colors) most = Math.max(most, await painted(page, id, color, 60));
      assert.ok(most > 20 || kFlat.includes(id), `${id} shows no line`);
    }
    await bring(page, 'stop-1');
    await screenshot(page, `report-${scheme}`);
    assert.deepEqual(page.problems, []);
    assert.deepEqual(page.asked, [`file://${report}`]);
    await page.close();
  });
}

test('a drag zooms all plots over time, the cursor tells values, the legend hides a line', async () => {
  const page = await open('light');
  await bring(page, 'forces');
  const canvas = page.locator('#forces canvas').first();
  const box = await canvas.boundingBox();
  await page.mouse.move(box.x + 0.6 * box.width, box.y + 60);
  await until(page, () => Number(document.querySelector('#forces .value').textContent) > 10);
  const before = await painted(page, 'forces', '--c0');
  await page.mouse.down();
  await page.mouse.move(box.x + 0.8 * box.width, box.y + 60, {steps: 4});
  await page.mouse.up();
  await until(page, () => !document.querySelector('#forces .reset').disabled);
  await bring(page, 'energy');
  assert.equal(await page.$eval('#energy .reset', (b) => b.disabled), false, 'zoomed together');
  await bring(page, 'forces');
  assert.notEqual(await painted(page, 'forces', '--c0'), before);
  await page.dblclick('#forces canvas', {position: {x: 300, y: 60}});
  await until(page, () => document.querySelector('#forces .reset').disabled);
  await page.locator('#forces .key').first().click();
  await until(page, () => document.querySelector('#forces .key').getAttribute('aria-pressed') === 'false');
  for (let k = 0; k < 600 && await painted(page, 'forces', '--c0') !== 0; ++k) await page.waitForTimeout(100);
  assert.equal(await painted(page, 'forces', '--c0'), 0, 'the left hand is hidden');
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('on paper and without scripts the plots are drawings, and no words overlap', async () => {
  const page = await open('dark', {javaScriptEnabled: false});
  await page.emulateMedia({media: 'print'});
  const overlaps = await page.evaluate(() => 0).catch(() => null);  // scripts are off for the page only
  assert.equal(overlaps, 0);
  assert.deepEqual(await faults(page), []);
  const ground = await page.$eval('body', (body) => getComputedStyle(body).backgroundColor);
  assert.equal(ground, 'rgb(255, 255, 255)', 'paper is white, also in the dark');
  await screenshot(page, 'report-print');
  await page.close();
});

test('the plots are files as well', () => {
  for (const name of ['stop-1', 'tracking', 'forces', 'joints', 'path-top', 'tick-histogram']) {
    assert.ok(statSync(join(svgs, `${name}.svg`)).size > 2000, name);
  }
});
