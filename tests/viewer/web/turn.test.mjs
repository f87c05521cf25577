// Tests that keys and the mouse wheel rotate the held handles.
import {after, test} from 'node:test';
import {asker, handleOnScreen, launch, look, near, open, ready, serve, take, until} from './harness.mjs';

const browser = await launch({unpainted: true});
const server = await serve({operator: 'browser', light: true});
const page = await open(browser, server.url);
const predictor = asker(() => page);
await ready(page);

after(async () => {
  await browser.close();
  await server.close();
});

// Returns the turn of a quaternion about the vertical [rad]. The quaternion has no other rotation.
const turnOf = ([w, , , z]) => 2 * Math.atan2(z, w);
const product = ([a, b, c, d], [e, f, g, h]) =>
  [a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g, a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e];

// Checks that both handles have turned by `angle` [rad] about the vertical through their midpoint.
function assertTurned(before, after, angle) {
  const middle = ({left, right}) => left.p.map((x, i) => (x + right.p[i]) / 2);
  near(middle(after), middle(before), 1e-9, 'the midpoint stays');
  for (const side of ['left', 'right']) {
    const [x, y, z] = before[side].p.map((value, i) => value - middle(before)[i]);
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    const moved = after[side].p.map((value, i) => value - middle(after)[i]);
    near(moved, [c * x - s * y, s * x + c * y, z], 1e-9, `${side}: the place`);
    const [w, ...axis] = before[side].q;
    const turn = product(after[side].q, [w, ...axis.map((value) => -value)]);
    near(turn.slice(1, 3), [0, 0], 1e-9, `${side}: about the vertical only`);
    near([turnOf(turn)], [angle], 1e-9, `${side}: the angle`);
  }
}

test('keys and the wheel turn both handles about their midpoint', async () => {
  await take(page, 'operator');
  await look(page, 'front');
  const degrees = Math.PI / 180;
  const bothHeld = () => until(page, () => {
    const {left, right} = window.predictor.handTargets();
    return left !== null && right !== null;
  });
  await page.focus('canvas');
  await page.keyboard.press('b');
  await bothHeld();
  const start = await predictor('handTargets');
  for (let i = 0; i < 9; i++) await page.keyboard.press(',');
  assertTurned(start, await predictor('handTargets'), 18 * degrees);
  for (let i = 0; i < 9; i++) await page.keyboard.press('.');
  assertTurned(start, await predictor('handTargets'), 0);
  await page.keyboard.press('b');

  const {x, y} = await handleOnScreen(page, 'left');
  await page.keyboard.down('Control');
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.keyboard.up('Control');
  await bothHeld();
  const grabbed = await predictor('handTargets');
  await page.mouse.wheel(0, 100);
  await until(page, (z) => window.predictor.handTargets().left.q[3] !== z, grabbed.left.q[3]);
  const turned = await predictor('handTargets');
  assertTurned(grabbed, turned, -2 * degrees);
  await page.mouse.move(x, y - 30, {steps: 3});
  await until(page, (z) => window.predictor.handTargets().left.p[2] > z + 0.01, turned.left.p[2]);
  near((await predictor('handTargets')).left.q, turned.left.q, 1e-9, 'a drag keeps the turn');
  await page.mouse.up();
});
