// Chromium, the page and a made-up server for the tests; the program itself is in program.mjs.
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
// Exit code by which ctest knows that a test was not run. Who asks for the long tests is to have them, and
// what lands was tested whole.
const required = process.env.PREDICTOR_SOAK !== undefined || process.env.PREDICTOR_BROWSER === 'required';
const kSkipped = required ? 1 : 77;
const kShots = process.env.PREDICTOR_SCREENSHOTS ?? null;
export const shotsWanted = kShots !== null;
const kPatienceMs = Number(process.env.PREDICTOR_PATIENCE ?? 150) * 1000;  // of every wait: a machine may be busy

// unpainted: for tests that look at no pixel of a scene, nor at how long one takes. Without a graphics card
// painting and putting it on the page are nearly all of a frame's work. For pictures it is painted all the same.
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

// Before a page loads: its scene is drawn, frame by frame, but not painted unless `window.painted` is set.
function leaveUnpainted() {
  for (const {prototype} of [WebGLRenderingContext, WebGL2RenderingContext]) {
    for (const name of ['drawArrays', 'drawElements', 'drawArraysInstanced', 'drawElementsInstanced',
                        'drawRangeElements']) {
      const paint = prototype[name];
      if (paint) prototype[name] = function(...args) { if (window.painted) paint.apply(this, args); };
    }
  }
}

// A page whose errors fail the test that asks for them.
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

// What the page tells of itself (web/src/inspect.ts), by name.
export const asker = (page) => (name, ...args) =>
  page().evaluate(([n, a]) => window.predictor[n](...a), [name, args]);

// Waits until so many more frames are drawn.
export async function frames(page, count) {
  const n = await page.evaluate(() => window.predictor.counters().frames);
  await until(page, (m) => window.predictor.counters().frames > m, n + count);
}

// Stands where a preset of the camera has it.
export async function look(page, view) {
  await page.click(`#view-${view}`);
  await until(page, (v) => window.predictor.view() === v, view);
  await page.waitForTimeout(500);  // the way there
  await frames(page, 2);
}

export async function take(page, what) {
  await page.click(`#${what}-lease`);
  await until(page, (w) => window.predictor.leases()[w] === window.predictor.client(), what);
}

// Of a handle on the page [px].
export function handleOnScreen(page, side) {
  return page.evaluate(
      (s) => window.predictor.project(window.predictor.shown().hands[s].virtual.p), side);
}

// Waits until the function holds on the page; its arguments are passed on.
export async function until(page, what, argument) {
  await page.waitForFunction(what, argument, {timeout: kPatienceMs, polling: 50});
}

// Waits until an element is seen, or is not. On a busy machine the run may fall silent for a moment, and
// the page says so: what is shown is waited for, not looked at once.
export async function shows(page, selector, visible = true) {
  await page.locator(selector).waitFor({state: visible ? 'visible' : 'hidden'});
}

export async function ready(page) {
  await until(page, () => window.predictor?.ready());
}

export async function waitFor(condition, words) {
  const end = Date.now() + kPatienceMs;
  while (!condition()) {
    if (Date.now() > end) assert.fail(`did not happen: ${words}`);
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
}

// Into PREDICTOR_SCREENSHOTS, if that is set; of a part of the page: clip {x, y, width, height} [px].
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

// Quaternions of opposite sign are the same rotation.
export function nearRotation(actual, expected, tolerance, words) {
  const dot = Math.abs(actual.reduce((sum, value, i) => sum + value * expected[i], 0));
  assert.ok(2 * Math.acos(Math.min(dot, 1)) <= tolerance, `${words}: ${actual}, not ${expected}`);
}
