// Opens a comparison of two runs and a page of the reproduction in Chromium. No words may overlap,
// and there must be no errors.
import assert from 'node:assert/strict';
import {mkdirSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {test} from 'node:test';
import {screenshot} from '../../viewer/web/harness.mjs';
import {bring, open, own, predictor, root} from './files.mjs';
import {assertPrints, faults} from './overlap.mjs';

const its = own('pages');
const {folder} = its;

// Every plot must become interactive, nothing may be loaded, and the page must not be wider than
// the window.
async function assertWhole(file) {
  const page = await open(its.browser, file);
  const ids = await page.$$eval('figure.plot', (all) => all.map((figure) => figure.id));
  assert.ok(ids.length > 0);
  for (const id of ids) await bring(page, id);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth + 1));
  assert.deepEqual(await faults(page), []);
  assert.deepEqual(page.problems, []);
  assert.deepEqual(page.asked, [`file://${file}`]);
  return page;
}

test('a comparison of runs with long names, in folders, prints without overlaps', async () => {
  const files = ['a', 'b'].map((name) => join(folder, name, 'bar_circle_2026-01-31_14-05-09 with a long name.mcap'));
  files.forEach((file, k) => {
    mkdirSync(dirname(file));
    predictor('simulate', join(root, 'scenarios/bar_circle.yaml'), '--quiet', '--duration', '6', '--seed', String(k + 1),
              '--record', file);
  });
  const page = join(folder, 'comparison.html');
  predictor('report', ...files, '-o', page, '--quiet');
  const printed = await assertPrints(its.browser, page);
  const words = await printed.$$eval('#forces text', (all) => all.map((t) => t.textContent));
  assert.ok(words.includes('a') && words.includes('b'), words.join());
  await screenshot(printed, 'comparison-print');
  await assertWhole(page);
});

test('labels that do not fit in one row are drawn in several rows', async () => {
  const name = (k) => `a condition with a long name, ${k}`;
  const files = [1, 2, 3, 4].map((k) => join(folder, `labelled${k}.mcap`));
  files.forEach((file, k) => predictor('simulate', join(root, 'scenarios/box_9kg.yaml'), '--quiet', '--duration', '3',
                                       '--record', file, '--label', `condition=${name(k)}`));
  const page = join(folder, 'labelled.html');
  predictor('report', ...files, '-o', page, '--quiet');
  const printed = await assertPrints(its.browser, page);
  // There are more rows of keys than panels, because each panel has all four keys.
  const keys = await printed.$$eval('#forces text', (all) => all.filter((t) => t.textContent.includes('long name'))
      .map((t) => Math.round(t.getBoundingClientRect().top)));
  assert.ok(new Set(keys).size > keys.length / 4, keys.join());
  await screenshot(printed, 'comparison-labels-print');
});

test('a page of the reproduction is complete and prints without overlaps', async () => {
  const out = join(folder, 'reproduction');
  predictor('reproduce', '-o', out, '--scenarios', join(root, 'scenarios'), '--only', 'relative_pose', '--quiet');
  const page = await assertWhole(join(out, 'index.html'));
  assert.equal(await page.$eval('#fig4-relative-pose', (figure) => 
      [...figure.querySelectorAll('text')].filter((t) => / \[(mm|°)\]$/.test(t.textContent)).length), 6, 'its panels');
  await screenshot(page, 'reproduction');
  await screenshot(await assertPrints(its.browser, join(out, 'index.html')), 'reproduction-print');
});
