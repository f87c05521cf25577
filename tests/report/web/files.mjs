// Runs the program and opens the pages that it writes as files.
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {after, before} from 'node:test';
import {fileURLToPath} from 'node:url';
import {launch} from '../../viewer/web/harness.mjs';

export const root = join(dirname(fileURLToPath(import.meta.url)), '../../..');
export const binary = process.env.PREDICTOR_BINARY ?? join(root, 'build/release/bin/predictor');
// The limit of every wait, long enough for a busy machine.
const kPatienceMs = 240_000;

// Returns a browser and a folder for the calling test file, {browser, folder}. They are available
// once its tests begin.
export function own(name) {
  const its = {folder: mkdtempSync(join(tmpdir(), `predictor-${name}-`))};
  before(async () => {
    its.browser = await launch({unpainted: true});
  });
  after(async () => {
    await its.browser?.close();
    rmSync(its.folder, {recursive: true, force: true});
  });
  return its;
}

// Runs the program to its end. A run that stops early (exit code 1) is accepted as well.
export function predictor(...args) {
  const done = spawnSync(binary, args, {encoding: 'utf8'});
  assert.ok(done.status === 0 || done.status === 1, `${args[0]}: ${done.stderr}`);
}

// Opens a page that collects its errors (`problems`) and its network requests (`asked`).
export async function open(browser, file, options = {}) {
  const page = await browser.newPage({viewport: {width: 1000, height: 900}, ...options});
  page.setDefaultTimeout(kPatienceMs);
  page.problems = [];
  page.asked = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (m) => m.type() === 'error' && page.problems.push(m.text()));
  page.on('request', (request) => page.asked.push(request.url()));
  await page.goto(`file://${file}`);
  return page;
}

export const until = (page, what, argument) => page.waitForFunction(what, argument, {polling: 50});

// Scrolls the plot into view and waits until it is drawn.
export async function bring(page, id) {
  await page.evaluate((name) => document.getElementById(name).scrollIntoView(), id);
  await until(page, (name) => (document.querySelector(`#${name} svg`)?.clientWidth ?? 0) > 300, id);
}

// Returns the data that a plot shows in one of the page's colours: its lines as paths, and the
// number of bars. Smaller shapes, such as the points at the cursor, do not count.
export const drawn = (page, id, color) => page.evaluate(([name, variable]) => {
  const wanted = getComputedStyle(document.documentElement).getPropertyValue(variable).trim();
  const paths = [...document.querySelectorAll(`#${name} svg :is(path, polygon)`)];
  const of = (attribute) => paths.filter((path) => path.getAttribute(attribute) === wanted);
  return {
    lines: of('stroke').filter((path) => Math.max(path.getBBox().width, path.getBBox().height) > 6).map((path) => path.getAttribute('d')),
    // The key of a legend is lower than a bar.
    bars: of('fill').filter((path) => path.getBBox().height > 3).length,
  };
}, [id, color]);
