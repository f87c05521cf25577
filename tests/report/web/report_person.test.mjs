// Tests the person in a report: pictures of the body, bars of scores, plots with intervals, and
// what is missing.
import assert from 'node:assert/strict';
import {join} from 'node:path';
import {before, test} from 'node:test';
import {screenshot} from '../../viewer/web/harness.mjs';
import * as files from './files.mjs';
import {drawn, own, predictor, root} from './files.mjs';
import {faults, printed} from './overlap.mjs';

const its = own('person');
const recording = join(its.folder, 'box.mcap');
const report = join(its.folder, 'box.html');

before(() => {
  predictor('simulate', join(root, 'scenarios/box_9kg.yaml'), '--quiet', '--duration', '8', '--record', recording);
  predictor('report', recording, '-o', report, '--quiet');
});

test('the body is drawn with its loads, and every plot has its intervals', async () => {
  const page = await files.open(its.browser, report);
  await page.evaluate(() => document.getElementById('person').scrollIntoView());
  await screenshot(page, 'report-person');
  assert.equal(await page.locator('#person .body svg').count(), 8, 'two views and the course of the run');
  // Nothing may lie outside its picture.
  const outside = await page.$$eval('#person .body svg', (all) => all.filter((svg) => {
    const box = svg.getBBox(), {width, height} = svg.viewBox.baseVal;
    return !(box.width > 50 && box.x >= -6 && box.y >= -6 && box.x + box.width <= width + 6 && box.y + box.height <= height + 6);
  }).length);
  assert.equal(outside, 0);
  const ids = await page.$$eval('#person figure.plot', (all) => all.map((figure) => figure.id));
  assert.ok(ids.includes('person-scores') && ids.length >= 6, ids.join());
  // Forces are measured, and muscles are computed for the nominal posture alone. All other plots
  // have intervals.
  let intervals = 0;
  for (const id of ids) {
    await files.bring(page, id);
    const {lines, bars} = await drawn(page, id, '--c0');
    assert.ok(lines.length > 0, id);
    const says = (await page.locator(`#${id}`).textContent()).includes('shaded areas');
    assert.equal(bars > 0, says, id);
    if (says) ++intervals;
  }
  assert.equal(ids.length - intervals, 3, ids.join());
  // The parts are as wide as the shares and must fill the whole bar.
  for (const bar of await page.$$eval('#person .shares', (all) => all.map((b) => [...b.children].map((c) => Number(c.style.flexGrow))))) {
    assert.ok(Math.abs(bar.reduce((a, b) => a + b, 0) - 1) < 2e-3, bar.join());
  }
  assert.deepEqual(page.problems, []);
  assert.deepEqual(page.asked, [`file://${report}`]);
  await page.close();
});

test('on paper no words overlap', async () => {
  const page = await files.open(its.browser, report);
  await printed(page);
  assert.deepEqual(await faults(page), []);
  await page.close();
});

test('a report states which data is missing', async () => {
  const page = join(its.folder, 'without.html');
  const unknown = join(its.folder, 'without.mcap');
  predictor('simulate', join(root, 'scenarios/box_9kg.yaml'), '--quiet', '--duration', '2', '--set', 'operator.stance=null',
            '--record', unknown);
  predictor('report', unknown, '-o', page, '--quiet');
  const opened = await files.open(its.browser, page);
  assert.match(await opened.locator('#person .warning').innerText(), /cannot be evaluated.*where the operator stands is not known/s);
  assert.equal(await opened.locator('#person figure').count(), 0);
  await opened.close();
});
