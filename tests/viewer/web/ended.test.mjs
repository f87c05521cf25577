// A run without a terminal ends by itself: its pages are told how, and do not look as if they had lost it.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {launch, open, ready, screenshot, shows, until} from './harness.mjs';
import {kRoundAndRound, lightCobot, Program} from './program.mjs';

let browser;
before(async () => (browser = await launch({unpainted: true})));
after(() => browser?.close());

async function begin(set) {
  const program = await Program.run('box_9kg.yaml', {set: [lightCobot(), ...set], terminal: false});
  const page = await open(browser, program.url, {viewport: {width: 1280, height: 720}});
  await ready(page);
  await until(page, () => window.predictor.stateText() === 'Running');
  return {program, page};
}

const text = (page, id) => page.locator(id).textContent();

async function looksEnded(page, how) {
  await until(page, () => window.predictor.stateText() === 'Ended');
  assert.equal(await text(page, '#banner'), how);
  await shows(page, '#stop', false);
  await shows(page, '#emergency');
  await shows(page, '#instruction', false);
  await shows(page, '#recording', false);
  assert.deepEqual(await page.evaluate(() => ['align', 'start', 'reset'].filter(
      (id) => !document.getElementById(id).disabled)), []);
  // It does not try again.
  const {connects} = await page.evaluate(() => window.predictor.counters());
  await page.waitForTimeout(1500);
  assert.equal((await page.evaluate(() => window.predictor.counters())).connects, connects);
  assert.equal(await text(page, '#banner'), how);
}

test('a stop ends it: the page says so, with the cause', async () => {
  const {program, page} = await begin(kRoundAndRound);
  await page.click('#stop');
  assert.equal(await program.ended, 1, program.output);
  await looksEnded(page, 'The run was stopped, and has ended.');
  assert.equal(await text(page, '#cause'), 'A person asked to stop.');
  assert.deepEqual(page.problems, []);
  await screenshot(page, 'ended');
  await page.close();
});

test('the end of its script', async () => {
  const {program, page} = await begin(['duration=25']);
  assert.equal(await program.ended, 0, program.output);
  await looksEnded(page, 'The run is finished.');
  assert.equal(await text(page, '#cause'), '');
  await page.close();
});

test('its console', async () => {
  const {program, page} = await begin(kRoundAndRound);
  await program.end();
  await looksEnded(page, 'The run was ended at its console.');
});
