// The paper's sudden push in real time: from zero to beyond the threshold in less than 0.1 s. Red
// must be displayed, and the warning must precede the stop.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {until} from './harness.mjs';
import {Rig} from './rig.mjs';

const kWarning = 0.8;
const kFrameTicks = 20;  // maximum between frames sent at 60 Hz
let page;
const rig = new Rig('push.yaml', {begun: () => ({page} = rig)});
const {states} = rig;

test('a short push is seen in red', async (t) => {
  // Stores the colours of the hands' arrows in each frame until the run stops.
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
  const warned = states.findIndex((s) => s[`${side}_peak`][0] > kWarning * parameters[3]);
  // The warning precedes the stop by about one frame. If a busy computer sends a frame late, there
  // may be no frame between them.
  const ticks = states[warned].tick - states[warned - 1].tick;
  if (ticks <= kFrameTicks)
    assert.equal(states[warned].state, 'RUN', 'the first state that warns is one of the run');
  else
    t.diagnostic(`a frame came after ${ticks} ticks: whether the warning came before the stop is not judged`);
  const seen = await page.evaluate((s) => window.seen[s], side);
  assert.ok(seen.includes('red'), [...new Set(seen)].join());
  assert.deepEqual(page.problems, []);
});
