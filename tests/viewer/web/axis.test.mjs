// Tests how the page draws a cobot whose first joint is prismatic.
import assert from 'node:assert/strict';
import {after, test} from 'node:test';
import {launch, near, nearRotation, open, ready, screenshot} from './harness.mjs';
import {linkPoses, Program} from './program.mjs';

const kScenario = 'linear_axis.yaml';
const kTolerance = 1e-3;  // [m], [rad]
const kStart = 0.2;       // of the carriage, in the scenario [m]

let browser;
let program;

after(async () => {
  await browser?.close();
  await program?.end();
});

test('a cobot on a linear axis has the pose that follows from its joints', async () => {
  browser = await launch();
  program = await Program.run(kScenario);
  const page = await open(browser, program.url, {viewport: {width: 1024, height: 768}});
  await ready(page);
  const names = Object.keys(linkPoses(kScenario, 'cobot', Array(7).fill(0)));
  assert.ok(names.includes('rail') && names.includes('flange'));
  const {q, poses} = await page.evaluate((links) => ({
    q: window.predictor.shown().cobotQ.slice(0, 7),
    poses: links.map((link) => window.predictor.linkPose(link)),
  }), names);
  assert.ok(Math.abs(q[0] - kStart) < 0.1, `the carriage is at ${q[0]} m`);
  const expected = linkPoses(kScenario, 'cobot', q);
  names.forEach((name, i) => {
    near(poses[i].p, expected[name].p, kTolerance, name);
    nearRotation(poses[i].q, expected[name].q, kTolerance, name);
  });
  await screenshot(page, 'linear-axis');
});
