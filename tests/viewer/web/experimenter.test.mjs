// The experimenter's page lists the events to come. The subject's page does not even ask for them.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {launch, open, ready, screenshot, serve} from './harness.mjs';

const kEvents = [
  {event: 'power_loss', meaning: 'the motors lose their power', trigger: 'at a random time between 2 and 4 s',
   begin: null, end: null},
  {event: 'sensor_bias', meaning: 'the reading jumps', trigger: 'at 1 s', begin: 1, end: 1.5},
];

let browser, server;

before(async () => {
  browser = await launch({unpainted: true});
  server = await serve({light: true});
  server.planned = kEvents;
});

after(async () => {
  await browser?.close();
  await server?.close();
});

test('the page at /experimenter lists the events, those to come as well', async () => {
  const page = await open(browser, server.url.replace('/#', '/experimenter#'), {});
  await ready(page);
  await page.waitForSelector('#planned-events li');
  const lines = await page.$$eval('#planned-events li', (items) => items.map((item) => item.textContent));
  assert.deepEqual(lines, [
    'power_loss (the motors lose their power) to come: at a random time between 2 and 4 s',
    'sensor_bias (the reading jumps) acted from 1.00 to 1.50 s',
  ]);
  // A new list replaces the old one.
  server.broadcast({type: 'events', complete: true, events: [{...kEvents[0], begin: 2.5}]});
  await page.waitForFunction(() => document.querySelector('#planned-events').textContent.includes('acts since 2.50 s'));
  assert.equal((await page.$$('#planned-events li')).length, 1);
  await screenshot(page, 'experimenter');
  await page.close();
});

test('any other page neither asks for the events nor shows a list', async () => {
  server.received.length = 0;
  const page = await open(browser, server.url, {});
  await ready(page);
  assert.equal(server.received.filter(({type}) => type === 'experimenter').length, 0);
  assert.ok(server.received.some(({type}) => type === 'hello'));
  assert.equal(await page.isVisible('#planned-events'), false);
  await page.close();
});
