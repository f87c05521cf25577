// Starts Chromium, the page and a fake server for the tests. program.mjs starts the program itself.
import assert from 'node:assert/strict';
import {existsSync, mkdirSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {FakeServer} from './fake_server.mjs';

const here = dirname(fileURLToPath(import.meta.url));
export const web = join(here, '../../../web');
const require = createRequire(join(web, 'package.json'));
const {chromium} = require('playwright-core');

const kChromium = process.env.PREDICTOR_CHROMIUM ?? '/usr/bin/chromium';
// With this exit code, ctest reports a skipped test. If long tests or a browser are required, a
// missing browser is a failure instead.
const required = process.env.PREDICTOR_SOAK !== undefined || process.env.PREDICTOR_BROWSER === 'required';
const kSkipped = required ? 1 : 77;
const kShots = process.env.PREDICTOR_SCREENSHOTS ?? null;
export const shotsWanted = kShots !== null;
// The limit of every wait, long enough for a busy machine.
const kPatienceMs = Number(process.env.PREDICTOR_PATIENCE ?? 150) * 1000;

// `unpainted` is for tests that check neither pixels of the scene nor frame times. Without a
// graphics card, painting and compositing take nearly all of a frame's time. Screenshots are
// painted in any case.
export async function launch({unpainted = false} = {}) {
  if (!existsSync(kChromium)) {
    console.log(`${required ? 'FAILED' : 'SKIPPED'}: no browser at ${kChromium}; PREDICTOR_CHROMIUM may name one, and ` +
                '`./dev test` installs one where there is a package.');
    process.exit(kSkipped);
  }
  const without = unpainted && !shotsWanted;
  const browser = await chromium.launch({
    executablePath: kChromium,
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader',
           '--enable-unsafe-swiftshader', '--autoplay-policy=no-user-gesture-required',
           ...(without ? ['--disable-gpu-compositing'] : [])],
  });
  return Object.assign(browser, {unpainted: without});
}

export async function serve(options = {}) {
  return new FakeServer(options).listen(Number(options.port ?? 0));
}

// Runs before a page loads. The page then processes the scene frame by frame, but paints it only if
// `window.painted` is set.
function leaveUnpainted() {
  for (const {prototype} of [WebGLRenderingContext, WebGL2RenderingContext]) {
    for (const name of ['drawArrays', 'drawElements', 'drawArraysInstanced', 'drawElementsInstanced',
                        'drawRangeElements']) {
      const paint = prototype[name];
      if (paint) prototype[name] = function(...args) { if (window.painted) paint.apply(this, args); };
    }
  }
}

// Opens a page whose errors fail the test that checks them.
export async function open(browser, url, options = {}) {
  const context = await browser.newContext({
    viewport: options.viewport ?? {width: 1024, height: 700}, colorScheme: options.scheme ?? 'dark',
    hasTouch: options.touch ?? false, ignoreHTTPSErrors: true,
  });
  const page = await context.newPage();
  page.setDefaultTimeout(kPatienceMs);
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(error.stack ?? String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error') page.problems.push(message.text());
  });
  if (browser.unpainted) await page.addInitScript(leaveUnpainted);
  if (options.before) await options.before(page);
  await page.goto(url);
  return page;
}

// Reads data that the page exposes (web/src/inspect.ts), by name.
export const asker = (page) => (name, ...args) =>
  page().evaluate(([n, a]) => window.predictor[n](...a), [name, args]);

// Waits until `count` more frames are drawn.
export async function frames(page, count) {
  const n = await page.evaluate(() => window.predictor.counters().frames);
  await until(page, (m) => window.predictor.counters().frames > m, n + count);
}

// Moves the camera to a preset.
export async function look(page, view) {
  await page.click(`#view-${view}`);
  await until(page, (v) => window.predictor.view() === v, view);
  await page.waitForTimeout(500);  // the camera's motion
  await frames(page, 2);
}

export async function take(page, what) {
  await page.click(`#${what}-lease`);
  await until(page, (w) => window.predictor.leases()[w] === window.predictor.client(), what);
}

// Returns the position of a handle on the page [px].
export function handleOnScreen(page, side) {
  return page.evaluate(
      (s) => window.predictor.project(window.predictor.shown().hands[s].virtual.p), side);
}

// Waits until the function returns true in the page. Passes its argument on.
export async function until(page, what, argument) {
  await page.waitForFunction(what, argument, {timeout: kPatienceMs, polling: 50});
}

// Waits until an element is visible or hidden. On a busy machine, the run may be silent for a
// moment, and the page reports this. Therefore the test waits instead of checking only once.
export async function shows(page, selector, visible = true) {
  await page.locator(selector).waitFor({state: visible ? 'visible' : 'hidden'});
}

export async function ready(page) {
  await until(page, () => window.predictor?.ready());
}

export async function waitFor(condition, words) {
  const end = Date.now() + kPatienceMs;
  while (!condition()) {
    if (Date.now() > end) assert.fail(`timed out: ${words}`);
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
}

// Saves a screenshot in PREDICTOR_SCREENSHOTS, if that is set. `clip` selects a part of the page:
// {x, y, width, height} [px].
export async function screenshot(page, name, clip) {
  if (!kShots) return;
  mkdirSync(kShots, {recursive: true});
  await page.screenshot({path: join(kShots, `${name}.png`), clip});
}

export function near(actual, expected, tolerance, words) {
  actual.forEach((value, i) => assert.ok(
      Math.abs(value - expected[i]) <= tolerance,
      `${words}[${i}]: ${value}, expected ${expected[i]} ± ${tolerance}`));
}

// Quaternions of opposite sign represent the same rotation.
export function nearRotation(actual, expected, tolerance, words) {
  const dot = Math.abs(actual.reduce((sum, value, i) => sum + value * expected[i], 0));
  assert.ok(2 * Math.acos(Math.min(dot, 1)) <= tolerance, `${words}: ${actual}, not ${expected}`);
}

export async function waitForText(locator, pattern) {
  for (let i = 0; i < 200; i++) {
    if (pattern.test(await locator.textContent())) return;
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  assert.match(await locator.textContent(), pattern);
}

// Returns what the page wrote to the console. The browser itself reports each refused connection
// while there is no server.
export function ownProblems(page) {
  return page.problems.filter((text) => !/ERR_CONNECTION_REFUSED|WebSocket connection/.test(text));
}
