// The program, and the pages that it writes, opened as files.
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
// Of every wait: a machine may be busy.
const kPatienceMs = 240_000;

// A browser and a folder of this file's own: {browser, folder} once its tests begin.
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

// Runs it to its end; one that stops early (exit code 1) is as good.
export function predictor(...args) {
  const done = spawnSync(binary, args, {encoding: 'utf8'});
  assert.ok(done.status === 0 || done.status === 1, `${args[0]}: ${done.stderr}`);
}

// A page with what went wrong in it (`problems`) and what it asked of the network (`asked`).
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

// Into view; waits until its plot is drawn.
export async function bring(page, id) {
  await page.evaluate((name) => document.getElementById(name).scrollIntoView(), id);
  await until(page, (name) => {
    const canvas = document.querySelector(`#${name} canvas`);
    return canvas && canvas.width > 300;
  }, id);
}
