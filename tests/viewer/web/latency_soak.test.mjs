// Measures how late a page shows the program's state, and checks that this delay does not grow: for
// ten minutes in the long form (PREDICTOR_SOAK=1), otherwise for a few seconds. The short form
// checks nothing that depends on speed.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {open, until} from './harness.mjs';
import {kRoundAndRound} from './program.mjs';
import {Rig} from './rig.mjs';

const kInFull = process.env.PREDICTOR_SOAK === '1';
const kWindows = kInFull ? 10 : 2;
const kTakes = kInFull ? 6 : 1;  // of a window
const kTakeMs = kInFull ? 10_000 : 3000;  // the page keeps the delays of its last ten seconds
const kLargestMovingMs = 2000;   // until the scene is drawn and moves
// This is Mann and Kendall's statistic. Among series without a trend, one in a hundred exceeds it.
const kTrend = 2.33;
const kNothingMs = 0.5;          // a growth of half a tick is negligible, however steady it is

const rig = new Rig('box_9kg.yaml', {set: kRoundAndRound, light: !kInFull});
// Tests for an upward trend relative to the scatter of the values (normal approximation).
function trend(values) {
  const n = values.length;
  const s = values.flatMap((a, i) => values.slice(i + 1).map((b) => Math.sign(b - a))).reduce((x, y) => x + y, 0);
  return (s - 1) / Math.sqrt(n * (n - 1) * (2 * n + 5) / 18);
}
// The growth from the first to the last value follows from the median of all slopes, so that a
// single disturbed window has no effect.
const growth = (values) => (values.length - 1) *
    middle(values.flatMap((a, i) => values.slice(i + 1).map((b, k) => (b - a) / (k + 1))));
const middle = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

// Returns the delays of the last seconds, and the counters so far.
const take = () => rig.page.evaluate(() => ({
  now: performance.now(), counters: window.predictor.counters(), latency: window.predictor.latency(),
}));

async function window() {
  const begin = await take();
  const takes = [];
  for (let i = 0; i < kTakes; i++) {
    await rig.page.waitForTimeout(kTakeMs);
    takes.push(await take());
  }
  const end = takes.at(-1);
  const seconds = (end.now - begin.now) / 1000;
  const of = (name) => (end.counters[name] - begin.counters[name]) / seconds;
  const step = (name) => ({p50: middle(takes.map((t) => t.latency[name].p50)),
                           p99: Math.max(...takes.map((t) => t.latency[name].p99))});
  return {received: step('sent → received'), drawn: step('tick → drawn'), states: of('states'),
          bytes: of('bytes'), frames: of('frames')};
}

test('the delay from the tick to its display does not grow', async (t) => {
  await until(rig.page, () => window.predictor.latency()['tick → drawn']?.count > 20);
  const seen = [];
  for (let k = 0; k < kWindows; k++) {
    const {received, drawn, states, bytes, frames} = await window();
    seen.push(drawn);
    const text = ({p50, p99}) => `${p50.toFixed(1)} / ${p99.toFixed(1)}`;
    t.diagnostic(`window ${k + 1}: sent to received ${text(received)}, tick to drawn ${text(drawn)} ms ` +
        `(p50 / p99); ${states.toFixed(0)} states, ${(bytes / 1000).toFixed(1)} kB and ` +
        `${frames.toFixed(0)} frames a second`);
    assert.ok(drawn.p50 > 0 && drawn.p50 <= drawn.p99);
    assert.ok(bytes > 0 && states > 0);
  }
  if (!kInFull) return;
  for (const which of ['p50', 'p99']) {
    const values = seen.map((d) => d[which]);
    const text = `${which} grows by ${growth(values).toFixed(2)} ms, trend ${trend(values).toFixed(2)} (${kTrend} is one)`;
    t.diagnostic(text);
    assert.ok(trend(values) < kTrend || growth(values) < kNothingMs, text);
  }
});

test('the page shows the moving scene within two seconds of being opened', async (t) => {
  const page = await open(rig.browser, 'about:blank', {viewport: {width: 1280, height: 720}});
  await rig.page.context().close();  // one page at a time, like a person
  await page.goto(rig.program.url, {waitUntil: 'commit'});
  // The test measures from the start of the navigation until two frames show the cobot at different
  // joint angles.
  const {loaded, moved} = await page.evaluate(() => new Promise((resolve) => {
    let first = null;
    let loadedMs = 0;
    const look = () => {
      const {predictor} = window;
      const {frames} = predictor?.counters() ?? {frames: 0};
      if (predictor?.ready() && frames > 0) {
        const q = predictor.shown().cobotQ;
        loadedMs ||= performance.now();
        first ??= {q, frames};
        if (frames > first.frames && q.some((v, i) => v !== first.q[i])) {
          return resolve({loaded: loadedMs, moved: performance.now()});
        }
      }
      requestAnimationFrame(look);
    };
    look();
  }));
  t.diagnostic(`all models drawn after ${loaded.toFixed(0)} ms, moving after ${moved.toFixed(0)} ms`);
  assert.ok(loaded > 0 && moved > loaded);
  assert.deepEqual(page.problems, []);
  if (kInFull) assert.ok(moved < kLargestMovingMs, `${moved} ms`);
});
