// For a recording, the page must show the recorded state at the requested time.
import assert from 'node:assert/strict';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import {asker, launch, near, open, ready, screenshot, shotsWanted, until, waitFor} from './harness.mjs';
import {channels, Client, kStates, lightCobot, Program, record} from './program.mjs';

const folder = mkdtempSync(join(tmpdir(), 'replay-'));
const file = join(folder, 'push.mcap');
let browser, program, page, client, recorded;
const states = [];
const predictor = asker(() => page);
const newest = () => states.at(-1);

before(async () => {
  record('push.yaml', file, shotsWanted ? [] : [lightCobot()]);
  recorded = new Map(channels(file, ['cobot.q', 'object.object.pose.p', 'run.state'])
                         .map((row) => [row[0], row]));
  browser = await launch({unpainted: true});
  program = await Program.replay(file);
  page = await open(browser, program.url, {viewport: {width: 1280, height: 720}});
  await ready(page);
  client = await Client.join(program.url);
  client.onState = (state) => states.push(state);
  await waitFor(newest, 'a state');
});

after(async () => {
  client?.close();
  await browser?.close();
  await program?.end();
  rmSync(folder, {recursive: true});
});

const text = (id) => page.locator(id).textContent();

async function seek(seconds) {
  await page.locator('#seek').fill(String(seconds));
  await waitFor(() => Math.abs(newest().tick - 1 - 1000 * seconds) < 5, `${seconds} s`);
}

async function pause() {
  if (/Pause/.test(await text('#play'))) await page.click('#play');
  await until(page, () => /Play/.test(document.getElementById('play').textContent));
}

test('it plays, starts again after its end, and has no stop button', async () => {
  await until(page, () => !document.getElementById('play').disabled);
  await pause();
  await seek(Math.max(...recorded.keys()) / 1000);  // the end of the recording
  await page.click('#play');
  await waitFor(() => newest().tick > 300 && newest().tick < 9000, 'moving on');
  assert.equal(await page.locator('#stop').isVisible(), false);
  assert.equal(await page.locator('#align').isVisible(), false);
  assert.equal(await page.locator('#emergency').isVisible(), false);
  await screenshot(page, 'replay');
});

test('a paused replay stands still and is not reported as a silent run', async () => {
  await pause();
  const {tick} = newest();
  await page.waitForTimeout(1500);
  assert.equal(newest().tick, tick);
  assert.equal(await page.locator('#banner').isVisible(), false);
});

test('seeking in both directions shows the recorded states', async () => {
  for (const seconds of [7, 2.5, 8.6]) {
    await seek(seconds);
    const state = newest();
    const row = recorded.get(state.tick);
    assert.ok(row, `tick ${state.tick}`);
    near(state.cobot_q.slice(0, 7), row.slice(2, 9), 1e-6, 'cobot.q');
    near(state.object.slice(0, 3), row.slice(9, 12), 1e-6, 'object');
    assert.equal(state.state, row[12]);
    await until(page, (tick) => window.predictor.shown()?.tick === tick, state.tick);
  }
});

test('single steps show consecutive states', async () => {
  await seek(3);
  const {tick} = newest();
  await page.getByLabel('One tick forward').click();
  await waitFor(() => newest().tick === tick + 1, 'a tick on');
  await page.getByLabel('100 ticks back').click();
  await waitFor(() => newest().tick === tick - 99, 'a hundred back');
});

test('the recorded stop is shown in words', async () => {
  await seek(9.6);
  await waitFor(() => ['STOPPING', 'HELD'].includes(kStates[newest().state]), 'the stop');
  await until(page, () => document.getElementById('cause').textContent.includes('force'));
  await screenshot(page, 'replay-stopped');
});

test('the speed of the replay can be changed', async () => {
  await seek(1);
  await page.selectOption('#speed', '4');
  await page.click('#play');
  await waitFor(() => newest().tick > 1500, 'moving on');
  const [a, at] = [newest().tick, performance.now()];
  await page.waitForTimeout(1000);
  const speed = (newest().tick - a) / (performance.now() - at);
  assert.ok(speed > 3 && speed < 5, `${speed} times as fast`);
  await pause();
});

test('a replay refuses the commands of a run', async () => {
  client.send({type: 'command', command: 'reset'});
  await waitFor(() => client.denials.length === 1, 'a denial');
  await page.waitForTimeout(300);
  client.send({type: 'replay', play: 1});
  await waitFor(() => client.denials.length === 2, 'another');
  assert.match(client.denials[0].reason, /recording/);
  assert.match(client.denials[1].reason, /control/);
});

test('no errors on the page', async () => {
  assert.deepEqual(page.problems, []);
  assert.equal(await predictor('leases').then((l) => l.control !== null), true);
});
