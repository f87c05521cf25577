// Tests other robots and scenes of the program: arms with STL meshes on a tablet, and the circle.
import assert from 'node:assert/strict';
import {after, test} from 'node:test';
import {
  asker, frames, launch, look, near, nearRotation, open, ready, screenshot, shotsWanted, until,
} from './harness.mjs';
import {kRoundAndRound, lightCobot, linkPoses, Program} from './program.mjs';

const kTolerance = 1e-3;  // [m], [rad]
const kLight = shotsWanted ? [] : [lightCobot()];

let browser;
let program;
let page;

after(async () => {
  await browser?.close();
  await program?.end();
});

const predictor = asker(() => page);

test('two UR5 with STL meshes have the poses that follow from their joint angles', async () => {
  browser = await launch({unpainted: true});
  program = await Program.run('dual_ur5.yaml', {set: [...kRoundAndRound, ...kLight]});
  page = await open(browser, program.url, {viewport: {width: 1024, height: 768}, touch: true});
  await ready(page);
  await page.tap('#ghosts');
  await until(page, () => window.predictor.ghostsReady());
  await frames(page, 1);
  for (const side of ['left', 'right']) {
    const names = Object.keys(linkPoses('dual_ur5.yaml', side, Array(6).fill(0)));
    const {q, poses} = await page.evaluate(([s, links]) => ({
      q: window.predictor.shown().hands[s].armQ.slice(0, 6),
      poses: links.map((link) => window.predictor.linkPose(`${s}:${link}`)),
    }), [side, names]);
    const expected = linkPoses('dual_ur5.yaml', side, q);
    assert.ok(names.includes('tool0'));
    names.forEach((name, i) => {
      near(poses[i].p, expected[name].p, kTolerance, name);
      nearRotation(poses[i].q, expected[name].q, kTolerance, name);
    });
  }
  assert.ok((await predictor('triangles')) > 5000, 'the meshes are drawn');
  await screenshot(page, 'tablet-ur5');
});

// Touches the screen through the browser's own protocol, with {x, y} for each finger. An empty list
// lifts all fingers.
async function touch(session, type, points) {
  await session.send('Input.dispatchTouchEvent', {
    type, touchPoints: points.map(({x, y}, id) => ({x, y, id})),
  });
}

async function middle() {
  const box = await page.locator('canvas').first().boundingBox();
  return {x: box.x + box.width / 2, y: box.y + box.height / 3};
}

test('one finger rotates the view, and two fingers zoom', async () => {
  const session = await page.context().newCDPSession(page);
  const {x, y} = await middle();
  const eye = () => predictor('cameraPosition');
  const start = await eye();
  await touch(session, 'touchStart', [{x, y}]);
  for (let i = 1; i <= 6; i++) await touch(session, 'touchMove', [{x: x + 20 * i, y}]);
  await touch(session, 'touchEnd', []);
  await frames(page, 3);
  const turned = await eye();
  const away = (p, q) => Math.hypot(...p.map((v, i) => v - q[i]));
  assert.ok(away(turned, start) > 0.3, `${start} → ${turned}`);
  assert.ok(Math.abs(turned[1] - start[1]) < 0.1, 'about the vertical');
  const object = (await predictor('shown')).object.p;
  const distance = (p) => away(p, [object[0], object[2], -object[1]]);
  await touch(session, 'touchStart', [{x: x - 40, y}, {x: x + 40, y}]);
  for (let i = 1; i <= 6; i++) {
    await touch(session, 'touchMove', [{x: x - 40 - 15 * i, y}, {x: x + 40 + 15 * i, y}]);
  }
  await touch(session, 'touchEnd', []);
  await frames(page, 3);
  assert.ok(distance(await eye()) < 0.8 * distance(turned), 'nearer');
  assert.deepEqual(page.problems, []);
});

test('the bar follows the drawn circle', async () => {
  await page.context().close();
  await program.end();
  program = await Program.run('bar_circle.yaml', {set: kLight});
  page = await open(browser, program.url, {viewport: {width: 1280, height: 720}});
  await ready(page);
  await look(page, 'operator');
  await until(page, () => window.predictor.counters().trail > 60);
  const error = await predictor('guidanceError');
  assert.ok(error < 0.02, `${error} m off the path`);
  assert.match(await page.locator('#guidance').textContent(), /^Off the path: \d+ mm$/);
  assert.match(await predictor('instruction'), /circle/);
  if (shotsWanted) await page.waitForTimeout(6000);
  await screenshot(page, 'circle-operator');
  await look(page, 'free');
  await screenshot(page, 'circle');
  assert.deepEqual(page.problems, []);
});
