// Tests the person on the page: the body in the scene, the gauges, the mirror, and the reasons why
// nothing is judged.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {pointsOf} from './fake_person.mjs';
import {
  asker, launch, near, open, ownProblems, ready, screenshot, serve, shotsWanted, shows, until, waitForText,
} from './harness.mjs';
import {Headset, withHeadset} from './headset.mjs';

let browser;
let server;
let page;
const predictor = asker(() => page);

async function fresh(options = {}, viewport = {width: 1280, height: 800}) {
  await page?.context().close();
  await server?.close();
  server = await serve({light: !shotsWanted, ground: [1, 0, -0.45], ...options});
  page = await open(browser, server.url, {viewport, before: options.before});
  await ready(page);
}

before(async () => (browser = await launch({unpainted: true})));
after(async () => {
  await browser?.close();
  await server?.close();
});

test('the body has the pose in the messages and the colours of its loads', async () => {
  await fresh();
  await until(page, () => window.predictor.body().visible);
  server.frozen = true;  // the run time does not change, so the messages repeat
  const count = await predictor('personCount');
  await until(page, (n) => window.predictor.personCount() > n + 12, count);
  const {points, colors} = await predictor('body');
  const {points: expected, parts} = await predictor('person');
  for (const [name, p] of Object.entries(expected)) near(points[name], p, 1e-6, name);
  const hands = {left: expected.left_hand, right: expected.right_hand};
  near(expected.left_shoulder, pointsOf(server.scene.viewpoint, hands).points.left_shoulder, 1e-9, 'shoulder');
  assert.deepEqual(Object.keys(colors).sort(), Object.keys(parts).sort());
  assert.notEqual(colors.lower_back, colors.left_elbow, 'different loads, different colours');
  await screenshot(page, 'person');
});

test('gauges, scores, damage and fatigue show the values in the message and their origin', async () => {
  const {gauges} = await predictor('person');
  const text = (selector) => page.locator(selector).innerText();
  assert.equal((await text('#gauge-lower_back_compression output')).trim(),
               `${gauges.lower_back_compression.value.toFixed(0)} N`);
  assert.equal(await page.getAttribute('#gauge-trunk_flexion', 'data-interval'),
               ['low', 'high'].map((end) => `${(gauges.trunk_flexion[end] * 180 / Math.PI).toFixed(0)} °`).join(' … '));
  assert.equal(await page.getAttribute('#gauge-left_hand_force', 'data-interval'), '', 'measured');
  assert.equal((await text('#score-rula output')).trim(), '4');
  const widths = await page.$$eval('#score-rula i', (all) => all.map((i) => Number(i.style.flexGrow)));
  near(widths, [0.1, 0.62, 0.24, 0.04], 1e-6, 'probabilities');
  assert.match(await text('#person-damage'), /lower back [\d.e-]+ %/);
  assert.match(await text('#person-fatigue'), /left shoulder 97 %/);
  const words = (await text('#person')).toLowerCase();
  for (const origin of ['measured', 'modelled', 'standard', 'operator is simulated']) assert.ok(words.includes(origin), origin);
});

test('damage beyond the range of its method is marked', async () => {
  const damage = page.locator('#person-damage');
  server.liftRange = 1.2;
  await waitForText(damage, /lower back [\d.e-]+ % \(beyond the range of the method\)/);
  server.liftRange = 0.4;
  await waitForText(damage, /lower back [\d.e-]+ %, left/);
});

test('the card states whether the head is measured', async () => {
  const head = page.locator('#person-head');
  await waitForText(head, /^The head is modelled\.$/);
  server.personHead = 'measured';
  await waitForText(head, /^The head is measured\.$/);
  server.personHead = 'impossible';
  await waitForText(head, /register again/);
  server.personHead = 'modelled';
  await waitForText(head, /^The head is modelled\.$/);
});

test('the card states what streams measure, and what is missing since when', async () => {
  const inputs = page.locator('#person-inputs');
  await waitForText(inputs, /^$/);
  server.personInputs = {heart_rate: 72.4, left_elbow: ['measured', 5], right_elbow: ['missing', 12.34], right_emg: ['missing', null]};
  await waitForText(inputs, /Left elbow: measured\./);
  const words = await inputs.innerText();
  for (const line of ['Heart rate: measured, 72 per minute.', 'Right elbow: missing since 12.3 s.',
                      'EMG of the right arm: missing since the start.'])
    assert.ok(words.includes(line), words);
  assert.ok(!words.includes('left arm'), words);
  server.personInputs = {};
  await waitForText(inputs, /^$/);
});

test('a warning appears while it is active in the evaluation', async () => {
  server.frozen = false;
  const warning = page.locator('[data-warning=left_shoulder]');
  server.runTime = 6.2;  // the made-up shoulder has a small load
  await warning.waitFor({state: 'detached'});
  server.runTime = 13.2;  // now it has a large load
  await warning.waitFor();
  assert.match(await warning.innerText(), /half of the mean strength/);
});

test('while the posture is unknown, no body is drawn, and the card states the reason', async () => {
  server.personStatus = 'no_hand';
  await until(page, () => !window.predictor.body().visible);
  await waitForText(page.locator('#person-why'), /No hand holds a handle/);
  assert.equal((await page.locator('#gauge-lower_back_shear output').innerText()).trim(), '–');
  server.personStatus = 'judged';
  await until(page, () => window.predictor.body().visible);
  server.sendingPerson = false;
  await until(page, () => !window.predictor.body().visible);
  await waitForText(page.locator('#person-why'), /stopped sending/);
  server.sendingPerson = true;
  await until(page, () => window.predictor.body().visible);
});

test('body and mirror can be switched on and off', async () => {
  await page.click('#body');
  await until(page, () => !window.predictor.body().visible);
  await page.click('#mirror');
  await until(page, () => window.predictor.body().mirror);
  await page.click('#body');
  await until(page, () => window.predictor.body().visible);
  await screenshot(page, 'person-mirror');
  await page.click('#mirror');
  await until(page, () => !window.predictor.body().mirror);
  assert.deepEqual(ownProblems(page), []);
});

test('for a scenario without a body, the page states what is missing and offers no switches', async () => {
  await fresh({person: 'The scenario does not describe the operator’s body.'});
  await waitForText(page.locator('#person-why'), /Not judged: The scenario does not describe/);
  await shows(page, '#body', false);
  await shows(page, '#mirror', false);
  assert.equal((await predictor('body')).visible, false);
  assert.deepEqual(ownProblems(page), []);
});

test('with an older server, which sends no person, the page has neither body nor card', async () => {
  await fresh({older: true});
  await shows(page, '#person', false);
  await shows(page, '#body', false);
  assert.equal(await predictor('personCount'), 0);
  assert.deepEqual(ownProblems(page), []);
});

test('in a headset, the body appears only in the mirror, which a plate switches on and off', async () => {
  await fresh({before: withHeadset, operator: 'browser'}, {width: 640, height: 400});
  const headset = new Headset(page);
  await headset.enter();
  await until(page, () => !window.predictor.body().visible);
  await headset.touchPlate('mirror');
  await until(page, () => window.predictor.body().mirror);
  await headset.look([0.1, 1.6, 0.45], -0.7, -0.25);
  await headset.screenshot('vr-mirror');
});
