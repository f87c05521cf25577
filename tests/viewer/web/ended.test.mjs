// After a run has ended, its page must show the results and offer the next steps. Without a
// terminal, the program must stay as long as a page is connected.
import assert from 'node:assert/strict';
import {existsSync, readFileSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import {launch, open, ready, screenshot, shows, take, until} from './harness.mjs';
import {capitalised, message} from './messages.mjs';
import {kRoundAndRound, lightCobot, Program} from './program.mjs';

const recording = join(tmpdir(), `predictor-ended-${process.pid}.mcap`);
const report = recording.replace('.mcap', '.html');
let browser;
before(async () => (browser = await launch({unpainted: true})));
after(async () => {
  await browser?.close();
  for (const file of [recording, report]) rmSync(file, {force: true});
});

async function begin(set, args = []) {
  const program = await Program.run('box_9kg.yaml', {set: [lightCobot(), ...set], terminal: false, args});
  const page = await open(browser, program.url, {viewport: {width: 1280, height: 720}});
  await ready(page);
  await until(page, () => window.predictor.stateText() === 'Running');
  return {program, page};
}

// Ends the run as planned, with the page's button. On a busy computer, a short run might end before
// a page is open.
async function end(page) {
  if ((await page.evaluate(() => window.predictor.leases())).control === null) await take(page, 'control');
  await page.click('#end');
}

const text = (page, id) => page.locator(id).textContent();
const tone = (page) => page.locator('.state-card').getAttribute('data-tone');
const resultsOf = (page, title) => until(
    page, (t) => document.getElementById('results-title').textContent === t &&
        window.predictor.phase() === 'open' && window.predictor.state() !== null, title);

// Removes errors that the browser itself reports while one server replaces another.
const own = (problems) => problems.filter(
    (problem) => !/ERR_CONNECTION_REFUSED|WebSocket connection/.test(problem));

test('a run that ended as planned shows its results, and runs again', async () => {
  const {program, page} = await begin(kRoundAndRound, ['--record', recording]);
  await end(page);
  await resultsOf(page, 'Finished');
  assert.equal(await text(page, '#results-how'), 'The run ended as planned.');
  assert.equal(await tone(page), 'ready', 'not red');
  await shows(page, '#results');
  for (const id of ['#stop', '#emergency', '#banner', '#align', '#recording']) await shows(page, id, false);
  const figures = await page.locator('#results-figures tbody tr').allTextContents();
  assert.match(figures[0], /^Duration(\d+ min )?\d+(\.\d)? s$/);
  assert.match(figures[1], /^Largest force\d+\.\d N\d+\.\d N$/);
  assert.equal(await page.locator('.results-curves canvas').count(), 2);
  await screenshot(page, 'ended');
  // The report must equal the file next to the recording.
  const download = page.waitForEvent('download');
  await page.click('#save-report');
  const saved = readFileSync(await (await download).path(), 'utf8');
  assert.ok(existsSync(report) && saved === readFileSync(report, 'utf8') && saved.length > 1e5);
  assert.equal(program.code, null, 'a page looks: the program stays');
  // The same scenario with the same settings must start without a further click.
  await page.click('#run-again');
  await until(page, () => window.predictor.stateText() === 'Running');
  await shows(page, '#results', false);
  await shows(page, '#stop');
  await end(page);
  await resultsOf(page, 'Finished');
  assert.deepEqual(own(page.problems), []);
  await page.context().close();
  assert.equal(await program.ended, 0, program.output);
});

test('after a stop, the page shows the cause in red', async () => {
  const {program, page} = await begin(kRoundAndRound);
  await page.click('#stop');
  await resultsOf(page, 'Stopped');
  assert.equal(await text(page, '#results-how'), 'The run was stopped before its planned end.');
  assert.equal(await text(page, '#results-cause'), `${capitalised('stop.operator.cause')}.`);
  assert.equal(await text(page, '#advice'), `${message('stop.operator.advice')} ${message('next.run_again')}`);
  assert.equal(await tone(page), 'stopped');
  assert.match(await text(page, '#results-remark'), /not recorded, so there is no report/);
  await shows(page, '#save-report', false);
  await shows(page, '#stop', false);
  await screenshot(page, 'ended-stopped');
  await page.context().close();
  assert.equal(await program.ended, 1, program.output);
});

test('a page with control ends a run as planned', async () => {
  const {program, page} = await begin(kRoundAndRound);
  await end(page);
  await resultsOf(page, 'Finished');
  assert.equal(await tone(page), 'ready');
  // A different scenario must also start without a further click.
  await page.selectOption('#scenario', 'bar_circle');
  await until(page, () => window.predictor?.ready() && /circle/i.test(window.predictor.scene()));
  await until(page, () => window.predictor.stateText() === 'Running');
  await program.end();
  // The program has ended. The page must report this, keep its last state, and not try to
  // reconnect.
  await until(page, () => window.predictor.stateText() === 'Ended');
  assert.equal(await text(page, '#banner'), 'The run was ended from the console.');
  assert.equal(await tone(page), 'calm');
  for (const id of ['#stop', '#emergency', '#instruction', '#recording']) await shows(page, id, false);
  const {connects} = await page.evaluate(() => window.predictor.counters());
  await page.waitForTimeout(1500);
  assert.equal((await page.evaluate(() => window.predictor.counters())).connects, connects);
});

test('with --no-stay the program ends with its run', async () => {
  const {program, page} = await begin(kRoundAndRound, ['--no-stay']);
  await end(page);
  assert.equal(await program.ended, 0, program.output);
  await until(page, () => window.predictor.stateText() === 'Ended');
  assert.equal(await text(page, '#banner'), 'The run ended as planned.');
  assert.equal(await tone(page), 'calm');
});
