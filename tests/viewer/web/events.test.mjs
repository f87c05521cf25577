// Tests that the page names the event that acts, with a recording of the real program.
import assert from 'node:assert/strict';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import {launch, open, ready, until, waitFor} from './harness.mjs';
import {channels, Client, lightCobot, Program, record} from './program.mjs';

const folder = mkdtempSync(join(tmpdir(), 'events-'));
const file = join(folder, 'hand_over_tool.mcap');
let browser, program, page, client, begins;
let newest = null;

before(async () => {
  // The only event of this scenario is the last but three in the list of hazards.
  record('hand_over_tool.yaml', file, [lightCobot()]);
  begins = channels(file, ['run.events']).findIndex((row) => row.at(-1) === 1) / 1000;
  browser = await launch({unpainted: true});
  program = await Program.replay(file);
  page = await open(browser, program.url, {viewport: {width: 1280, height: 720}});
  await ready(page);
  client = await Client.join(program.url);
  client.onState = (state) => (newest = state);
  await until(page, () => !document.getElementById('play').disabled);
  if (/Pause/.test(await page.locator('#play').textContent())) await page.click('#play');
});

after(async () => {
  client?.close();
  await browser?.close();
  await program?.end();
  rmSync(folder, {recursive: true});
});

async function seek(seconds) {
  await page.locator('#seek').fill(String(seconds));
  await waitFor(() => newest && Math.abs(newest.tick - 1 - 1000 * seconds) < 5, `${seconds} s`);
  await until(page, (tick) => window.predictor.shown()?.tick === tick, newest.tick);
}

const shownEvent = () => page.evaluate(() => {
  const element = document.getElementById('hazards');
  return element.hidden ? '' : element.textContent;
});

test('the page names the acting event of the scenario, and no other', async () => {
  assert.ok(begins > 2.5, `the gripper opens at ${begins} s`);
  assert.deepEqual(client.welcome.scene.acting, []);
  await seek(begins - 1);
  assert.equal(await shownEvent(), '');
  await seek(begins + 1);
  assert.match(await shownEvent(), /^Event: the cobot's gripper opens\b/);
  const later = await Client.join(program.url);
  assert.match(later.welcome.scene.acting.join(), /^the cobot's gripper opens\b/);
  later.close();
  await seek(begins - 1);
  assert.equal(await shownEvent(), '');
});
