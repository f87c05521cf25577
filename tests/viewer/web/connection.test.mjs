// Tests the connection of the page in Chromium: admission, delays, a silent run, and a lost server.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {
  asker, launch, open, ownProblems, ready, screenshot, serve, shotsWanted, shows, until, waitFor,
  waitForText,
} from './harness.mjs';
import {message} from './messages.mjs';

let browser;
let server;
let page;

before(async () => {
  browser = await launch({unpainted: true});
  server = await serve({light: !shotsWanted, simulated: false});
  page = await open(browser, server.url);
  await ready(page);
});

after(async () => {
  await browser?.close();
  await server?.close();
});

const predictor = asker(() => page);

test('the code is removed from the address, and the token stays only in this tab', async () => {
  assert.equal(new URL(page.url()).hash, '');
  assert.equal(await predictor('phase'), 'open');
  const kept = await page.evaluate(() => ({
    session: Object.values(sessionStorage).join(), local: Object.values(localStorage).join(),
    cookie: document.cookie,
  }));
  assert.ok(kept.session.length >= 40);
  assert.equal(kept.cookie, '');
  assert.ok(!kept.local.includes(kept.session));
});

test('the clocks are compared, and every step of the delay is shown', async () => {
  await until(page, () => window.predictor.latency()['tick → drawn']?.count > 5);
  const clock = await predictor('clock');
  assert.ok(clock.roundTripMs >= 0);
  const before = Number(process.hrtime.bigint()) / 1e6;
  const now = await page.evaluate(() => performance.now());
  const after = Number(process.hrtime.bigint()) / 1e6;
  const slack = clock.roundTripMs + 1;
  assert.ok(now + clock.offsetMs > before - slack && now + clock.offsetMs < after + slack);
  const latency = await predictor('latency');
  for (const [step, figures] of Object.entries(latency)) {
    if (!figures) continue;
    assert.ok(figures.p50 <= figures.p99, step);
    assert.ok(figures.p50 > -clock.roundTripMs, step);
  }
  const sum = ['tick → sent', 'sent → received', 'received → drawn']
                  .reduce((total, step) => total + latency[step].p50, 0);
  assert.ok(sum > 0);
});

test('the medians of the delays are sent for the recording', async () => {
  await waitFor(() => server.received.some((m) => m.type === 'latency'), 'a latency message');
  const report = server.received.findLast((m) => m.type === 'latency');
  assert.ok(report.rendered_ms >= report.received_ms);
  assert.ok(Number.isFinite(report.offset_ms));
  await waitFor(() => server.received.filter((m) => m.type === 'heartbeat').length >= 2, 'heartbeats');
});

// ---- a run that does not answer ------------------------------------------------------------------

test('a silent run is reported within a second although the server still answers', async () => {
  server.command('reset');
  server.state = 'RUN';
  await until(page, () => window.predictor.stateText() === 'Running');
  const {connects} = await predictor('counters');
  server.sending = false;
  await until(page, (title) => window.predictor.stateText() === title, message('link.silent.title'));
  await shows(page, '#stop', false);
  assert.equal(await page.locator('#emergency').textContent(), message('link.silent.emergency'));
  await shows(page, '#emergency');
  await shows(page, '#banner');
  assert.equal(await predictor('instruction'), '');
  assert.equal(await predictor('phase'), 'open');
  assert.equal((await predictor('counters')).connects, connects, 'pings are answered');
  await screenshot(page, 'silent');
  server.sending = true;
  await until(page, () => window.predictor.stateText() === 'Running');
  await shows(page, '#stop');
  await shows(page, '#banner', false);
});

test('a stop that the run does not accept is reported immediately', async () => {
  server.deaf = true;
  await page.click('#stop');
  await until(page, () => window.predictor.stateText() === 'Not stopped');
  assert.match(await page.locator('#emergency').textContent(), new RegExp(message('link.ignored.emergency')));
  await shows(page, '#emergency');
  await shows(page, '#stop');
  server.deaf = false;
  await page.click('#stop');
  await until(page, () => window.predictor.stateText() === 'Stopped, held');
  await shows(page, '#emergency', false);
  server.command('reset');
  server.state = 'RUN';
});

test('two scenarios with the same title are distinguished by their files', async () => {
  const chosen = () => page.evaluate(() => document.getElementById('scenario').value);
  assert.equal(await chosen(), 'made_up');
  await page.evaluate(() => (window.loadedOnce = true));
  server.file = 'made_up_too';
  const {port} = server;
  await server.close();
  await server.listen(port);
  await until(page, () => !window.loadedOnce && window.predictor?.ready());
  assert.equal(await chosen(), 'made_up_too');
});

// ---- lost server -------------------------------------------------------------------------------

test('a lost connection is reported plainly, and restored with the token', async () => {
  const {reconnects} = await predictor('counters');
  const {port} = server;
  await server.close();
  await until(page, () => window.predictor.phase() === 'lost');
  await shows(page, '#stop', false);
  assert.equal(await page.locator('#emergency').textContent(), message('link.silent.emergency'));
  await shows(page, '#emergency');
  await shows(page, '#banner');
  assert.equal(await predictor('stateText'), 'Not connected');
  await screenshot(page, 'lost');
  await server.listen(port);
  await until(page, (n) => window.predictor.counters().reconnects === n + 1, reconnects);
  await shows(page, '#stop');
  await shows(page, '#banner', false);
  await until(page, () => window.predictor.state() !== null);
});

test('a client without a seat keeps its token and is admitted later', async () => {
  const token = () => page.evaluate(() => sessionStorage.getItem('predictor.token'));
  const kept = await token();
  server.full = true;
  const {port} = server;
  await server.close();
  await server.listen(port);
  await until(page, () => /There is no room/.test(document.getElementById('banner').textContent));
  assert.equal(await token(), kept);
  assert.equal(await page.locator('#pin').isVisible(), false);
  server.full = false;
  await until(page, () => window.predictor.phase() === 'open' && window.predictor.state());
  assert.equal(await token(), kept);
});

test('a restarted server requires a PIN and refuses wrong ones', async () => {
  server.renew();
  const {port} = server;
  await server.close();
  await server.listen(port);
  await page.waitForSelector('#pin');
  assert.match(await page.locator('#pin-error').textContent(), /type the digits/);
  await screenshot(page, 'pairing');
  assert.ok(await page.locator('#pair').isDisabled());
  await page.fill('#pin', '000000');
  await page.keyboard.press('Enter');
  await waitForText(page.locator('#pin-error'), /not valid/);
  await page.fill('#pin', '111111');
  await page.click('#pair');
  await until(page, () => window.predictor.phase() === 'open');
  assert.equal(await predictor('role'), 'look');
  assert.ok(await page.locator('#control-lease').isDisabled());
  await shows(page, '#stop');
});

test('no error was written to the console', () => {
  assert.deepEqual(ownProblems(page), []);
});
