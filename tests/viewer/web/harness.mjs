// Chromium, the page and a server for the tests. PREDICTOR_VIEWER_URL (with its code) names a running
// server; without it a made-up one is started, and only then tests may use its hooks.
import assert from 'node:assert/strict';
import {mkdirSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {FakeServer} from './fake_server.mjs';

const here = dirname(fileURLToPath(import.meta.url));
export const web = join(here, '../../../web');
const require = createRequire(join(web, 'package.json'));
const {chromium} = require('playwright-core');

export const realUrl = process.env.PREDICTOR_VIEWER_URL ?? null;
export const needsHooks = {skip: realUrl ? 'needs the made-up server' : false};
const kShots = process.env.PREDICTOR_SCREENSHOTS ?? null;
export const shotsWanted = kShots !== null;
const kPatienceMs = 40_000;  // of every wait: a machine may be busy

export const iwer = join(web, 'node_modules/iwer/build/iwer.min.js');

export async function launch() {
  return chromium.launch({
    executablePath: process.env.PREDICTOR_CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader',
           '--enable-unsafe-swiftshader', '--autoplay-policy=no-user-gesture-required'],
  });
}

export async function serve(options = {}) {
  return new FakeServer(options).listen(Number(options.port ?? 0));
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
  if (options.before) await options.before(page);
  await page.goto(url);
  return page;
}

// Waits until the function holds on the page; its arguments are passed on.
export async function until(page, what, argument) {
  await page.waitForFunction(what, argument, {timeout: kPatienceMs, polling: 50});
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

// Into PREDICTOR_SCREENSHOTS, if that is set.
export async function screenshot(page, name) {
  if (!kShots) return;
  mkdirSync(kShots, {recursive: true});
  await page.screenshot({path: join(kShots, `${name}.png`)});
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
