// Tests the questionnaire in a browser, served by `predictor survey`.
import assert from 'node:assert/strict';
import {spawn, spawnSync} from 'node:child_process';
import {mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {after, before, test} from 'node:test';
import {launch, open, screenshot, until, waitFor} from './harness.mjs';

const root = join(dirname(fileURLToPath(import.meta.url)), '../../..');
const binary = process.env.PREDICTOR_BINARY ?? join(root, 'build/release/bin/predictor');
const kViewport = {viewport: {width: 900, height: 1000}, scheme: 'light'};

let browser;
let folder;

before(async () => {
  browser = await launch({unpainted: true});
  folder = mkdtempSync(join(tmpdir(), 'predictor-survey-'));
  for (const name of ['one', 'two']) writeFileSync(join(folder, `${name}.mcap`), 'a recording');
});
after(async () => {
  await browser?.close();
  if (folder) rmSync(folder, {recursive: true});
});

// Starts `predictor survey` with a recording and waits until it serves.
async function ask(recording, ...args) {
  const survey = {text: '', code: null};
  survey.child = spawn(binary, ['survey', 'ask', join(folder, recording), '--port', '0', ...args]);
  survey.child.stderr.on('data', (text) => (survey.text += text));
  survey.child.stdout.on('data', (text) => (survey.text += text));
  survey.ended = new Promise((resolve) => survey.child.on('close', (code) => {
    survey.code = code;
    resolve(code);
  }));
  await waitFor(() => /http:\S+/.test(survey.text) || survey.code !== null, 'the address');
  survey.url = survey.text.match(/http:\S+/)?.[0];
  assert.ok(survey.url, survey.text);
  return survey;
}

const report = (...args) => spawnSync(binary, ['survey', ...args], {encoding: 'utf8', cwd: folder});
const answers = () => readdirSync(folder).filter((name) => name.endsWith('.survey.json'));
const visible = (page, id) => page.locator(id).isVisible();

// Answers every statement with this level.
async function agreeWithAll(page, score) {
  for (let i = 1; i <= 8; i++) await page.check(`#S${i} input[value="${score}"]`);
}

async function pseudonymOf(page) {
  await page.waitForSelector('#stored', {state: 'visible'});
  return page.locator('#your-pseudonym').textContent();
}

let pseudonym;

test('a person agrees, answers, sees the errors, and gets a pseudonym', async () => {
  const survey = await ask('one.mcap', '--condition', 'emulated');
  const page = await open(browser, survey.url, kViewport);
  await page.waitForSelector('#consent', {state: 'visible'});
  assert.equal(await visible(page, '#form'), false);
  assert.ok(!page.url().includes('code'), 'the code does not stay in the address');
  await screenshot(page, 'survey-consent');

  await page.reload();  // an admitted browser must stay admitted
  await page.click('#agree');
  assert.equal(await visible(page, '#condition'), false, 'the experimenter said it');
  assert.match(await page.locator('#S5 legend').textContent(),
               /S5\. The emulated human-robot collaboration task is as responsive as the real task\./);

  await page.click('#send');
  await page.waitForSelector('#problem', {state: 'visible'});
  assert.match(await page.locator('#problem').textContent(), /No statement was answered/);

  await agreeWithAll(page, 1);
  await page.check('#S3 input[value=""]');
  await page.fill('#age', '230');
  await page.fill('#comment', 'Larger <resistance> in the “real” task.');
  await page.selectOption('#sex', 'female');
  await page.click('#send');
  await page.waitForSelector('#problem', {state: 'visible'});
  assert.match(await page.locator('#problem').textContent(), /age must be .* from 1 to 120/);
  await page.fill('#age', '23');
  await page.evaluate(() => socket.close());  // happens after a computer was asleep
  await until(page, () => tries > 0);
  await until(page, () => socket.readyState === WebSocket.OPEN && tries === 0);
  assert.equal(await visible(page, '#problem'), false);
  await screenshot(page, 'survey-form');
  await page.click('#send');
  pseudonym = await pseudonymOf(page);
  await screenshot(page, 'survey-stored');
  assert.match(pseudonym, /^[2-9A-HJ-NP-Z]{8}$/);
  assert.equal(await survey.ended, 0);
  assert.deepEqual(page.problems, []);
  await page.context().close();

  assert.deepEqual(answers(), [`one.${pseudonym}.emulated.survey.json`]);
  const stored = JSON.parse(readFileSync(join(folder, answers()[0]), 'utf8'));
  assert.deepEqual(stored.answers, {S1: 1, S2: 1, S3: null, S4: 1, S5: 1, S6: 1, S7: 1, S8: 1});
  assert.equal(stored.age, 23);
  assert.equal(stored.sex, 'female');
  assert.equal(stored.comment, 'Larger <resistance> in the “real” task.');
  assert.equal(stored.recording, 'one.mcap');
  for (const personal of [pseudonym, 'resistance', 'female', '23'])
    assert.ok(!survey.text.replace(survey.url, '').includes(personal), survey.text);
});

test('the same person answers after the other run; the two are compared', async () => {
  const survey = await ask('two.mcap');
  const page = await open(browser, survey.url, kViewport);
  await page.click('#agree');
  await agreeWithAll(page, 2);
  await page.click('#send');
  await page.waitForSelector('#problem', {state: 'visible'});
  assert.match(await page.locator('#problem').textContent(), /system that you used/);
  await page.check('#condition input[value=real]');
  const wrong = (pseudonym[0] === 'A' ? 'B' : 'A') + pseudonym.slice(1);
  await page.fill('#pseudonym', wrong.toLowerCase());
  await page.click('#send');
  await page.waitForSelector('#problem', {state: 'visible'});
  assert.match(await page.locator('#problem').textContent(), /not a pseudonym from this questionnaire/);
  await page.fill('#pseudonym', pseudonym.toLowerCase());
  await page.click('#send');
  assert.equal(await pseudonymOf(page), pseudonym);
  assert.equal(await survey.ended, 0);
  assert.deepEqual(page.problems, []);
  await page.context().close();

  const {status, stdout} = report('report', folder, '-o', join(folder, 'study.html'));
  assert.equal(status, 0);
  assert.match(stdout, /After the emulated system: 1 person, age 23 years/);
  assert.match(stdout, /Emulated minus real, 1 person who answered for both/);
  const shown = await open(browser, `file://${join(folder, 'study.html')}`, kViewport);
  await shown.locator('#answers').scrollIntoViewIfNeeded();
  await shown.waitForSelector('#answers svg');
  // There must be one cross for each answer about the emulated system, and one in the legend.
  assert.equal(await shown.evaluate(() => {
    const color = getComputedStyle(document.documentElement).getPropertyValue('--c0').trim();
    return document.querySelectorAll(`#answers svg path[fill="${color}"]`).length;
  }), 7 + 1);
  assert.equal(await shown.locator('blockquote').textContent(),
               'Larger <resistance> in the “real” task.');
  assert.deepEqual(shown.problems, []);
  await screenshot(shown, 'survey-report');
  await shown.context().close();
});

test('the recording states which system was used', async () => {
  const {status, stderr} = spawnSync(
      binary, ['simulate', join(root, 'scenarios/bar_circle.yaml'), '--set', 'mode=direct', '--duration',
               '0.1', '--quiet', '--record', join(folder, 'direct.mcap')], {encoding: 'utf8'});
  assert.equal(status, 0, stderr);
  const survey = await ask('direct.mcap');
  const page = await open(browser, survey.url, kViewport);
  await page.click('#agree');
  assert.equal(await visible(page, '#condition'), false);
  await agreeWithAll(page, 0);
  await page.click('#send');
  const other = await pseudonymOf(page);
  assert.equal(await survey.ended, 0);
  assert.ok(answers().includes(`direct.${other}.real.survey.json`), answers());
  await page.context().close();
  assert.equal(report('remove', other, folder).status, 0);
});

test('the answers of a person who declines are not stored', async () => {
  const before = answers();
  const survey = await ask('one.mcap', '--condition', 'real');
  const page = await open(browser, survey.url, kViewport);
  await page.click('#decline');
  await page.waitForSelector('#declined', {state: 'visible'});
  assert.equal(await survey.ended, 0);
  assert.deepEqual(answers(), before);
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('a used address does not admit another browser', async () => {
  const survey = await ask('one.mcap', '--condition', 'real');
  const first = await open(browser, survey.url, kViewport);
  await first.waitForSelector('#consent', {state: 'visible'});
  const second = await open(browser, survey.url, kViewport);
  await second.waitForSelector('#lost', {state: 'visible'});
  assert.match(await second.locator('#lost-reason').textContent(), /already used/);
  survey.child.kill('SIGINT');
  assert.equal(await survey.ended, 0);
  await first.waitForSelector('#lost', {state: 'visible'});
  assert.match(await first.locator('#lost-reason').textContent(), /Nothing was stored/);
  assert.match(survey.text, /No answer was given/);
  await first.context().close();
  await second.context().close();
});

test('only the answer with the given pseudonym is removed', () => {
  assert.equal(answers().length, 2);
  assert.equal(report('remove', 'ABCDEFGH', folder).status, 2);
  assert.equal(report('remove', pseudonym, folder).status, 0);
  assert.deepEqual(answers(), []);
  assert.ok(readdirSync(folder).includes('one.mcap'), 'the recording stays');
  const again = report('remove', pseudonym, folder);
  assert.equal(again.status, 2);
  assert.match(again.stderr, /There is no answer/);
  assert.equal(report('report', folder).status, 2);
});
