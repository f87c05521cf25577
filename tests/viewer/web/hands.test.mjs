// Tests a person's hands without a robot: with the mouse, and in the (emulated) headset with
// controllers and with hands.
import assert from 'node:assert/strict';
import {after, test} from 'node:test';
import {
  asker, frames as framesOf, handleOnScreen as onScreen, launch, look, near, open, ready, screenshot, serve,
  shotsWanted, take, until, waitFor,
} from './harness.mjs';
import {Headset, withHeadset} from './headset.mjs';
import {capitalised, message} from './messages.mjs';

let browser;
let server;
let page;
let headset;

const predictor = asker(() => page);
const hands = (side) => server.received.filter((m) => m.type === 'hand' && m.hand === side);

const inside = () => predictor('immersive');
const board = async () => (await inside()).board;
const stops = () => server.received.filter((m) => m.type === 'stop').length;
const reports = () => server.received.filter((m) => m.type === 'immersive');

async function fresh(options) {
  await browser?.close();
  await server?.close();
  browser = await launch({unpainted: true});
  // The scene has few triangles unless the test takes screenshots.
  server = await serve({operator: 'browser', light: !shotsWanted, ...options.server});
  page = await open(browser, server.url, options.page);
  await ready(page);
}

const handleOnScreen = (side) => onScreen(page, side);
const frames = (count) => framesOf(page, count);

after(async () => {
  await browser?.close();
  await server?.close();
});

// ---- mouse ---------------------------------------------------------------------------------------

test('without the lease, dragging turns the camera and takes no handle', async () => {
  await fresh({page: {viewport: {width: 900, height: 640}}});
  const {x, y} = await handleOnScreen('left');
  const eye = await predictor('cameraPosition');
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 80, y, {steps: 4});
  await page.mouse.up();
  await frames(2);
  assert.equal(server.received.some((m) => m.type === 'hand'), false);
  assert.notDeepEqual(await predictor('cameraPosition'), eye);
});

test('a handle is dragged in the plane of the screen, and the object follows', async () => {
  await take(page, 'operator');
  await look(page, 'front');
  const start = (await predictor('shown')).object.p;
  const {x, y} = await handleOnScreen('left');
  await page.mouse.move(x, y);
  await page.mouse.down();
  await waitFor(() => hands('left').length > 0, 'a hand message');
  assert.equal(hands('left')[0].grip, true);
  const held = (await predictor('shown')).hands.left.virtual.p;
  near(hands('left')[0].p, held, 0.02, 'the hand begins at the handle');
  const eye = await predictor('cameraPosition');
  await page.mouse.move(x + 60, y - 40, {steps: 5});
  await waitFor(() => hands('left').at(-1).p[2] > held[2] + 0.03, 'the hand higher');
  const target = hands('left').at(-1);
  assert.ok(Math.abs(target.p[0] - held[0]) < 0.06, 'seen from the front: hardly any x');
  assert.ok(target.p[1] > held[1] + 0.03, 'seen from the front, right is +y');
  assert.deepEqual(await predictor('cameraPosition'), eye);
  assert.equal(hands('right').length, 0);
  await until(page, (z) => window.predictor.shown().object.p[2] > z + 0.01, start[2]);
  await screenshot(page, 'mouse');
  await page.mouse.up();
  await waitFor(() => hands('left').at(-1).grip === false, 'letting go');
  assert.deepEqual(await predictor('handTargets'), {left: null, right: null});
});

test('Shift restricts the drag to the vertical, and Ctrl moves both hands', async () => {
  await look(page, 'free');
  const {x, y} = await handleOnScreen('right');
  const before = server.received.length;
  await page.keyboard.down('Control');
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.keyboard.up('Control');
  await page.keyboard.down('Shift');
  await page.mouse.move(x + 1, y);
  await page.mouse.move(x + 50, y - 50, {steps: 6});
  await frames(2);
  const sent = () => server.received.slice(before).filter((m) => m.type === 'hand' && m.grip);
  const of = (side) => sent().filter((m) => m.hand === side);
  await waitFor(() => of('left').length > 3 && of('right').length > 3, 'both hands');
  for (const side of ['left', 'right']) {
    const [first, last] = [of(side)[0], of(side).at(-1)];
    near(last.p.slice(0, 2), first.p.slice(0, 2), 0.01, `${side}: x and y`);
    assert.ok(last.p[2] > first.p[2] + 0.02, `${side}: up`);
  }
  const lift = (side) => of(side).at(-1).p[2] - of(side)[0].p[2];
  assert.ok(Math.abs(lift('left') - lift('right')) < 0.01);
  await page.mouse.up();
  await page.keyboard.up('Shift');
});

test('each hand sends at most 60 messages per second, and never a force', async () => {
  const {x, y} = await handleOnScreen('left');
  await page.mouse.move(x, y);
  await page.mouse.down();
  await waitFor(() => hands('left').at(-1).grip, 'grip');
  const times = [];
  const take = server.take.bind(server);
  server.take = (socket, message) => {
    if (message.type === 'hand') times.push(performance.now());
    take(socket, message);
  };
  await page.waitForTimeout(1500);
  server.take = take;
  await page.mouse.up();
  assert.ok(times.length > 3, 'a hand that rests repeats itself');
  assert.ok(times.length <= 1.6 * 60, `${times.length} in 1.5 s`);
  const keys = new Set(server.received.filter((m) => m.type === 'hand').flatMap(Object.keys));
  assert.deepEqual([...keys].sort(), ['client', 'grip', 'hand', 'p', 'q', 'type']);
});

test('keys take, move and release a handle', async () => {
  await look(page, 'front');
  await page.focus('canvas');
  const before = hands('left').length;
  const start = (await predictor('shown')).hands.left.virtual.p;
  await page.keyboard.press('l');
  await waitFor(() => hands('left').length > before && hands('left').at(-1).grip, 'a grip');
  const first = hands('left').at(-1).p;
  near(first, start, 0.03, 'begins at the handle');
  const moved = (axis, least, words) =>
    waitFor(() => hands('left').at(-1).p[axis] - first[axis] > least, words);
  for (let i = 0; i < 4; i++) await page.keyboard.press('PageUp');
  await moved(2, 0.018, 'up');
  for (let i = 0; i < 4; i++) await page.keyboard.press('ArrowRight');
  await moved(1, 0.018, 'seen from the front, right is +y');
  await page.keyboard.press('Shift+ArrowUp');
  await waitFor(() => first[0] - hands('left').at(-1).p[0] > 0.0005, 'away from the eye');
  assert.ok(first[0] - hands('left').at(-1).p[0] < 0.003, 'finely');
  const rightGrips = hands('right').filter((m) => m.grip).length;
  await page.keyboard.press('b');
  await waitFor(() => hands('right').filter((m) => m.grip).length > rightGrips, 'the other hand too');
  await page.keyboard.press('l');
  await waitFor(() => hands('left').at(-1).grip === false, 'letting go of one');
  await page.focus('#theme');
  await waitFor(() => hands('right').at(-1).grip === false, 'moving the focus lets go');
});

test('a page that loses the lease releases the handles', async () => {
  const {x, y} = await handleOnScreen('left');
  await page.mouse.move(x, y);
  await page.mouse.down();
  await until(page, () => window.predictor.handTargets().left !== null);
  server.leases.operator = null;
  server.broadcast({type: 'leases', ...server.leaseMessage()});
  await until(page, () => window.predictor.handTargets().left === null);
  await page.mouse.up();
  assert.deepEqual(page.problems, []);
});

// ---- headset -------------------------------------------------------------------------------------

async function enterVr(options) {
  const viewport = shotsWanted ? {width: 1280, height: 720} : {width: 640, height: 400};
  await fresh({server: options, page: {viewport, before: withHeadset}});
  if (options?.simulated !== false) await take(page, 'operator');
  headset = new Headset(page);
  await headset.enter();
}

test('an immersive session begins with the scene in front of the person', async () => {
  await enterVr();
  const object = (await predictor('shown')).object.p;
  const [x, y, z] = await predictor('inHeadsetSpace', object);
  assert.ok(Math.abs(x) < 0.05, 'straight ahead');
  assert.ok(z < -0.4 && z > -0.9, 'at arm’s length');
  assert.ok(Math.abs(y - object[2]) < 1e-6, 'the floor is the floor');
  await until(page, () => window.predictor.immersive().board.title === 'Running');
  await headset.look([0, 1.5, 0.35], 0, -0.6);
});

test('the headset reports at most fifty times per second', async () => {
  const before = server.received.length;
  const start = Date.now();
  await waitFor(() => server.received.slice(before).filter((m) => m.type === 'immersive').length > 4,
                'signs of life');
  const seconds = (Date.now() - start) / 1000;
  const reports = server.received.slice(before).filter((m) => m.type === 'immersive');
  assert.ok(reports.every((m) => m.active === true));
  assert.ok(reports.length <= 50 * seconds + 2);
  // The scene is not registered, so the head is not a measurement.
  assert.ok(reports.every((m) => m.registration === undefined && m.posed === undefined));
  // In W, the head must have the same pose as in the device.
  const [x, y, z] = await predictor('inHeadsetSpace', reports.at(-1).p);
  near([x, y, z], [0, 1.5, 0.35], 0.05, 'head');
});

test('the time of the drawn state is reported, and does not advance if the picture freezes', async () => {
  const newest = () => reports().at(-1).drawn;
  const begin = newest();
  assert.ok(begin > 0 && begin <= Number(process.hrtime.bigint()), 'the run’s clock');
  await waitFor(() => newest() > begin, 'a newer picture');
  const {tones} = await inside();
  server.sending = false;
  await until(page, (title) => window.predictor.immersive().board.title === title, message('link.silent.title'));
  assert.equal((await board()).text, `${message('link.simulated.emergency')}.`);
  assert.equal((await inside()).tones, tones + 1);
  await headset.frames(2);
  const still = newest();
  const count = reports().length;
  await waitFor(() => reports().length > count + 3, 'further signs of life');
  assert.equal(newest(), still);
  server.sending = true;
  await until(page, () => window.predictor.immersive().board.title === 'Running');
  await waitFor(() => newest() > still, 'a newer picture');
});

test('the stop button works while the headset has lost its position', async () => {
  await page.evaluate(() => {
    window.viewerPose = XRFrame.prototype.getViewerPose;
    XRFrame.prototype.getViewerPose = () => null;
  });
  await headset.frames(2);
  const before = stops();
  await headset.button('left', 'y-button', 1);
  await waitFor(() => stops() === before + 1, 'a stop');
  await headset.button('left', 'y-button', 0);
  await until(page, () => window.predictor.immersive().board.title === 'Stopped, held');
  await page.evaluate(() => (XRFrame.prototype.getViewerPose = window.viewerPose));
  server.command('reset');
  server.state = 'RUN';
  await until(page, () => window.predictor.immersive().board.title === 'Running');
});

test('a controller takes the handle that it touches and moves it', async () => {
  const {left, right} = (await predictor('shown')).hands;
  await headset.place('right', left.virtual.p);  // either hand takes the nearest handle
  await headset.frames(2);
  const before = server.received.length;
  await headset.button('right', 'squeeze', 1);
  await waitFor(() => server.received.slice(before).some((m) => m.type === 'hand'), 'a grip');
  const first = server.received.slice(before).find((m) => m.type === 'hand');
  assert.equal(first.hand, 'left');
  near(first.p, left.virtual.p, 0.02, 'begins at the handle');
  const up = [...left.virtual.p];
  up[2] += 0.15;
  await headset.place('right', up);
  await waitFor(() => hands('left').at(-1).p[2] > left.virtual.p[2] + 0.12, 'carried up');
  await until(page, (z) => window.predictor.shown().object.p[2] > z, right.virtual.p[2] + 0.12);
  await headset.button('right', 'squeeze', 0);
  await waitFor(() => hands('left').at(-1).grip === false, 'letting go');
  // A hand far from any handle must take nothing.
  await headset.place('right', [up[0], up[1], up[2] + 0.5]);
  const count = hands('left').length;
  await headset.button('right', 'trigger', 1);
  await headset.frames(3);
  await headset.button('right', 'trigger', 0);
  assert.equal(hands('left').length, count);
});

test('controllers on the handles register too, and drift is reported', async () => {
  const state = await predictor('shown');
  const places = {
    left: await predictor('inHeadsetSpace', state.hands.right.real.p),
    right: await predictor('inHeadsetSpace', state.hands.left.real.p),
  };
  await headset.placeInSpace('left', places.left);
  await headset.touchPlate('attach', places.right);
  await until(page, () => /Registered/.test(window.predictor.immersive().board.prompt));
  await until(page, () => window.predictor.immersive().drift < 0.005);
  const {board: {alarm}, registration} = await predictor('immersive');
  assert.equal(alarm, '');
  await waitFor(() => reports().at(-1).registration, 'a measured head');
  const head = reports().at(-1);
  assert.deepEqual(head.registration, registration);
  const ageMs = (Number(process.hrtime.bigint()) - head.posed) / 1e6;
  assert.ok(ageMs > -50 && ageMs < 5000, `${ageMs} ms`);
  const [x, y, z] = places.left;
  await headset.placeInSpace('left', [x, y + 0.02, z]);
  await until(page, () => window.predictor.immersive().drift > 0.015);
  await page.waitForTimeout(700);
  await headset.frames(2);
  assert.equal((await predictor('immersive')).board.alarm, '', '20 mm are allowed');
  await headset.placeInSpace('left', [x, y + 0.06, z]);
  await until(page, () => /off by \d\d mm/.test(window.predictor.immersive().board.alarm));
  await waitFor(() => reports().at(-1).registration === undefined, 'no measurement after drift');
  await headset.placeInSpace('left', places.left);
  await until(page, () => window.predictor.immersive().board.alarm === '');
});

test('points that do not match are refused, and the previous registration stays valid', async () => {
  const before = (await predictor('immersive')).registration;
  await headset.placeInSpace('left', [-0.6, 1, -0.4]);
  await headset.touchPlate('attach', [0.6, 1, -0.4]);
  await until(page, () => /Not registered/.test(window.predictor.immersive().board.prompt));
  assert.deepEqual((await predictor('immersive')).registration, before);
});

test('above the warning level the controller pulses', async () => {
  const {pulses} = await predictor('immersive');
  const {p} = (await predictor('shown')).hands.left.virtual;
  await headset.place('right', p);
  await headset.frames(2);
  await headset.button('right', 'squeeze', 1);
  await until(page, () => window.predictor.handTargets().left !== null);
  server.force = {left: [0, 0, 20, 0, 0, 0], right: [0, 0, 0, 0, 0, 0]};
  await until(page, () => window.predictor.immersive().board.hands[0].level === 'orange');
  await headset.frames(3);
  assert.equal((await predictor('immersive')).pulses, pulses);
  server.force.left = [0, 0, 27, 0, 0, 0];
  await until(page, (n) => window.predictor.immersive().pulses > n, pulses);
  assert.equal((await predictor('immersive')).board.hands[0].level, 'red');
  assert.equal((await board()).hands[0].quantity, 'force');
  if (shotsWanted) await headset.look([0.1, 1.25, 0.55], 0.35, -0.35);  // box and board
  await headset.screenshot('vr-arrows');
  // A torque counts like a force. The one that is nearer to its threshold determines the colour.
  server.force.left = [0, 0, 5, 0, 0, 4.6];
  await until(page, () => window.predictor.immersive().board.hands[0].quantity === 'torque');
  const {level, text} = (await board()).hands[0];
  assert.deepEqual({level, text}, {level: 'red', text: '4.6 / 5.00 N·m'});
  const before = (await inside()).pulses;
  await until(page, (n) => window.predictor.immersive().pulses > n, before);
  server.force = null;
  await headset.button('right', 'squeeze', 0);
});

test('the plate stops; the headset shows the cause and plays a tone', async () => {
  const {tones} = await predictor('immersive');
  await headset.touchPlate('stop');
  await until(page, () => window.predictor.immersive().board.title === 'Stopped, held');
  const seen = await predictor('immersive');
  assert.match(seen.board.text, new RegExp(capitalised('stop.operator.cause')));
  assert.equal(seen.board.tone, 'stopped');
  assert.equal(seen.tones, tones + 1);
  await headset.screenshot('vr-stop');
  server.command('reset');
  server.state = 'RUN';
  await until(page, () => window.predictor.immersive().board.title === 'Running');
  const stops = server.received.filter((m) => m.type === 'stop').length;
  await headset.button('right', 'b-button', 1);
  await waitFor(() => server.received.filter((m) => m.type === 'stop').length === stops + 1,
                'the stop button of the controller');
  await headset.button('right', 'b-button', 0);
});

test('a tracked hand takes a handle by a pinch', async () => {
  server.command('reset');
  server.state = 'RUN';
  server.cause = {cause: 'none', hand: -1, value: 0, limit: 0};
  await page.evaluate(() => (window.xrDevice.primaryInputMode = 'hand'));
  await headset.frames(3);
  const {right} = (await predictor('shown')).hands;
  const [x, y, z] = await predictor('inHeadsetSpace', right.virtual.p);
  await page.evaluate((p) => window.xrDevice.hands.right.position.set(...p), [x, y, z]);
  await headset.frames(3);
  const before = hands('right').length;
  await page.evaluate(() => window.xrDevice.hands.right.updatePinchValue(1));
  await waitFor(() => hands('right').length > before && hands('right').at(-1).grip, 'a pinch grips');
  await page.evaluate(() => window.xrDevice.hands.right.updatePinchValue(0));
  await waitFor(() => hands('right').at(-1).grip === false, 'an open hand lets go');
});

test('another page sees what the headset sees', async () => {
  const other = await open(browser, server.url, {viewport: {width: 800, height: 560}});
  await ready(other);
  await other.waitForSelector('#view-headset:not([hidden])');
  await other.click('#view-headset');
  await until(other, () => window.predictor.view() === 'headset');
  const n = await other.evaluate(() => window.predictor.counters().frames);
  await until(other, (m) => window.predictor.counters().frames > m + 1, n);
  const head = server.received.findLast((m) => m.type === 'immersive' && m.p).p;
  near(await other.evaluate(() => window.predictor.cameraPosition()),
       [head[0], head[2], -head[1]], 0.02, 'camera');
  await screenshot(other, 'spectator');
  assert.deepEqual(other.problems, []);
  await other.context().close();
});

test('leaving the session releases the handles and restores the page', async () => {
  await page.evaluate(() => document.getElementById('enter-vr').click());
  await until(page, () => !window.predictor.immersive().active);
  await waitFor(() => server.received.findLast((m) => m.type === 'immersive').active === false,
                'the end of the session');
  near(await predictor('inHeadsetSpace', [1, 2, 3]), [1, 3, -2], 1e-9, 'the world is unmoved');
  await frames(2);
  assert.deepEqual(page.problems, []);
});

// ---- headset, real arms --------------------------------------------------------------------------

// Places the controllers on the handles for a registration. Returns their positions.
async function register() {
  const {hands: h} = await predictor('shown');
  const places = {left: await predictor('inHeadsetSpace', h.right.real.p),
                  right: await predictor('inHeadsetSpace', h.left.real.p)};
  await headset.placeInSpace('left', places.left);
  await headset.touchPlate('attach', places.right);
  await until(page, () => /^Registered/.test(window.predictor.immersive().board.prompt));
  return places;
}

async function leaveVr() {
  await page.evaluate(() => document.getElementById('enter-vr').click());
  await until(page, () => !window.predictor.immersive().active);
}

test('with real arms, the page warns that leaving the session stops them', async () => {
  await enterVr({operator: 'person', simulated: false});
  server.frozen = true;
  assert.match((await board()).advice, /Leaving VR stops the real arms/);
  await until(page, () => document.getElementById('enter-vr').textContent === 'Leave VR (stops the arms)');
  server.state = 'IDLE';
  await until(page, () => document.getElementById('enter-vr').textContent === 'Leave VR');
  server.state = 'RUN';
});

test('a registration of an earlier session must be checked by touching a handle', async () => {
  await register();
  await leaveVr();
  await frames(2);
  await headset.enter();
  await until(page, () => /not checked/.test(window.predictor.immersive().board.alarm));
  const {hands: h} = await predictor('shown');
  const [x, y, z] = await predictor('inHeadsetSpace', h.left.real.p);
  await headset.touch('right', [x, y + 0.06, z]);
  assert.match((await board()).prompt, /^\d+ mm from the handle/);
  assert.match((await board()).alarm, /not checked/);
  await headset.touch('right', [x, y + 0.01, z]);
  assert.match((await board()).prompt, /^Checked: \d+ mm off/);
  assert.equal((await board()).alarm, '');
});

test('a hand that holds a real handle but is tracked elsewhere causes an alarm', async () => {
  const {hands: h} = await predictor('shown');
  server.state = 'IDLE';
  await until(page, () => !window.predictor.shown().hands.left.gripping);
  for (const side of ['left', 'right']) {
    await headset.placeInSpace(side, await predictor('inHeadsetSpace', h[side].real.p));
  }
  await headset.frames(2);
  server.state = 'RUN';  // now both hands hold
  await until(page, () => window.predictor.shown().hands.left.gripping);
  await until(page, () => window.predictor.immersive().drift < 0.005);
  assert.equal((await board()).alarm, '');
  const [x, y, z] = await predictor('inHeadsetSpace', h.left.real.p);
  await headset.placeInSpace('left', [x, y + 0.06, z]);
  await until(page, () => /off by \d\d mm/.test(window.predictor.immersive().board.alarm));
  await headset.placeInSpace('left', [x, y, z]);
  await until(page, () => window.predictor.immersive().board.alarm === '');
  assert.deepEqual(page.problems, []);
});
