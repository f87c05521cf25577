// Repeats the paper's sudden push in real time, from zero to beyond the threshold in less than 0.1
// s. Red must be displayed, and the warning must precede the stop.
import assert from 'node:assert/strict';
import {rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, test} from 'node:test';
import {until} from './harness.mjs';
import {channels, kStates} from './program.mjs';
import {Rig} from './rig.mjs';

const kWarning = 0.8;
const recording = join(tmpdir(), `predictor-sudden-${process.pid}.mcap`);
let page;
const rig = new Rig('push.yaml', {args: ['--record', recording], begun: () => ({page} = rig)});
const {states} = rig;
after(() => rmSync(recording, {force: true}));

// Returns the states of the run from the tick at which the force on a hand exceeds a limit [N].
function statesBeyond(side, limit) {
  const rows = channels(recording, ['run.state', `hands.${side}.wrench.force`]);
  const first = rows.findIndex((row) => Math.hypot(...row.slice(-3)) > limit);
  assert.ok(first > 0, `a force beyond ${limit} N`);
  return rows.slice(first).map((row) => kStates[row.at(-4)]);
}

test('a short push is shown in red, and the warning precedes the stop', async () => {
  // This code stores the colours of the hands' arrows in each frame until the run stops.
  await page.evaluate(() => {
    window.seen = {left: [], right: []};
    const look = () => {
      for (const side of ['left', 'right']) window.seen[side].push(window.predictor.arrowColour(side));
      requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
  });
  await rig.reach('HELD');
  await until(page, () => window.predictor.stateText() === 'Stopped, held');
  const {parameters, cause, cause_hand: hand} = states.at(-1);
  assert.equal(cause, 1, 'stopped by the force');
  const side = ['left', 'right'][hand];
  const seen = await page.evaluate((s) => window.seen[s], side);
  assert.ok(seen.includes('red'), [...new Set(seen)].join());
  assert.deepEqual(page.problems, []);
  // The force takes about 15 ms from the warning to the threshold, which is less than from frame to
  // frame. Therefore the test uses the recording, which has every tick, to find which comes first.
  await rig.program.end();
  const warned = statesBeyond(side, kWarning * parameters[3]);
  assert.equal(warned[0], 'RUN', 'the first tick that warns is one of the run');
  assert.ok(warned.indexOf('STOPPING') >= 5, `stopped ${warned.indexOf('STOPPING')} ticks later`);
});
