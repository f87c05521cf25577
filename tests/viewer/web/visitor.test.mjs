// Tests the page for a visitor. It must offer the hands, invite the visitor to take the handles,
// show results, and fit in a small window.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {
  asker, handleOnScreen, launch, look, open, ownProblems, ready, screenshot, serve, shotsWanted,
  shows, until, waitFor,
} from './harness.mjs';

const kSmall = {width: 900, height: 640};
const kResults = {
  figures: [{name: 'Duration', value: '25.0 s'}, {name: 'Largest force', left: '18.2 N', right: '17.9 N'}],
  curves: [{title: 'Force at the handles', unit: 'N', limit: 30, step: 1, left: [3, 8, 18.2, 4],
            right: [2, 9, 17.9, 5]}],
  recording: 'runs/box.mcap', remark: '', report: '/report.html',
};

let browser;
let server;
let page;
const predictor = asker(() => page);
const sent = (type) => server.received.filter((m) => m.type === type);

async function fresh(options = {}, viewport = kSmall) {
  await page?.context().close();
  await server?.close().catch(() => undefined);
  server = await serve({light: !shotsWanted, ...options});
  page = await open(browser, server.url, {viewport});
  await ready(page);
}

before(async () => (browser = await launch({unpainted: true})));
after(async () => {
  await browser?.close();
  await server?.close().catch(() => undefined);
});

test('the only page shows the offer of the hands in the scene', async () => {
  await fresh({operator: 'browser'});
  await shows(page, '#take-hands');
  assert.equal(await page.locator('#invitation').textContent(), 'Take the handsthen drag a ring.');
  await screenshot(page, 'by-hand-first');
  // While a second page is open, no page may show the offer. The offer must return when the second
  // page has closed.
  const other = await open(browser, server.url, {viewport: kSmall});
  await ready(other);
  await shows(page, '#invitation', false);
  await shows(other, '#invitation', false);
  await other.context().close();
  await shows(page, '#take-hands');
});

test('with a scripted operator or a run that is not in RUN, no hands are offered', async () => {
  await fresh();
  await shows(page, '#invitation', false);
  await fresh({operator: 'browser', state: 'IDLE'});
  await shows(page, '#invitation', false);
});

test('the handles invite the visitor to drag, and the first drag shows force and threshold', async () => {
  await fresh({operator: 'browser'});
  await page.click('#take-hands');
  await until(page, () => window.predictor.leases().operator === window.predictor.client());
  assert.equal((await predictor('leases')).control, await predictor('client'));
  await shows(page, '#take-hands', false);
  assert.match(await page.locator('#invitation').textContent(), /Drag a ring\./);
  await look(page, 'front');
  const {x, y} = await handleOnScreen(page, 'left');
  await page.mouse.move(x, y);
  await until(page, () => window.predictor.hovered() === 'left');
  assert.equal(await page.locator('.scene canvas').evaluate((c) => c.style.cursor), 'grab');
  await page.mouse.down();
  await page.mouse.move(x, y - 60, {steps: 5});
  await shows(page, '#gauge-left');
  assert.match(await page.locator('#gauge-left').textContent(), /^\d+ N of 30 N$/);
  await shows(page, '#gauge-right', false);
  await shows(page, '#invitation', false);
  await screenshot(page, 'by-hand-drag');
  await page.mouse.up();
  await shows(page, '#gauge-left', false);
});

// Returns the distance of an element from the square around a handle's ring, in px. It is below 0 if they overlap.
async function distanceFromRing(selector, side) {
  const box = await page.locator(selector).boundingBox();
  const {x, y} = await handleOnScreen(page, side);
  const radius = await predictor('ringOnScreen', side);
  const dx = Math.max(box.x - x, x - box.x - box.width), dy = Math.max(box.y - y, y - box.y - box.height);
  return Math.max(dx, dy) - radius;
}

test('the invitation covers no ring', async () => {
  for (const viewport of [kSmall, {width: 1280, height: 800}]) {
    await fresh({operator: 'browser'}, viewport);
    for (const view of ['front', 'side', 'operator']) {
      await look(page, view);
      for (const side of ['left', 'right']) {
        const distance = await distanceFromRing('#invitation', side);
        assert.ok(distance > 0, `${viewport.width} x ${viewport.height}, ${view}, ${side}: ${distance} px`);
      }
    }
  }
  await fresh({operator: 'browser'});
  await page.click('#take-hands');
  await shows(page, '#take-hands', false);
  for (const side of ['left', 'right']) assert.ok(await distanceFromRing('#invitation', side) > 0, side);
});

test('the page with the hands can end the run, which has no duration', async () => {
  assert.match(await page.locator('#run-time').textContent(), /^\d+\.\d s$/, 'no end time is shown');
  await page.click('#end');
  await waitFor(() => sent('command').some((m) => m.command === 'end'), 'the end');
  await until(page, () => window.predictor.stateText() === 'Done, held');
});

test('a ring stays large enough on the page for a finger', async () => {
  await fresh({operator: 'browser'});
  const near = await predictor('ringOnScreen', 'left');
  const canvas = await page.locator('.scene canvas').boundingBox();
  await page.mouse.move(canvas.x + canvas.width - 40, canvas.y + canvas.height - 40);
  await page.mouse.wheel(0, 900);
  await page.waitForTimeout(1000);
  const far = await predictor('ringOnScreen', 'left');
  assert.ok(far < near, `${far} px from afar, ${near} px near by`);
  assert.ok(far >= 15, `${far} px`);
});

// ---- results ---------------------------------------------------------------------------------------

test('after a run, figures and curves are shown, without red', async () => {
  await fresh();
  await server.finish('The run ended as planned.', kResults);
  await until(page, () => document.getElementById('results-title').textContent === 'Finished');
  await shows(page, '#results');
  await shows(page, '#stop', false);
  await shows(page, '#emergency', false);
  assert.equal(await page.locator('.state-card').getAttribute('data-tone'), 'ready');
  assert.deepEqual(await page.locator('#results-figures tbody tr').allTextContents(),
                   ['Duration25.0 s', 'Largest force18.2 N17.9 N']);
  assert.equal(await page.locator('.results-curves canvas').count(), 1);
  assert.ok((await predictor('counters')).points > 0, 'the plots of the run stay');
  // The results must be hidden and then shown again.
  await page.click('#hide-results');
  await shows(page, '#results', false);
  await page.click('#show-results');
  await shows(page, '#results');
  // A page that is opened later must show the same.
  await page.reload();
  await until(page, () => document.getElementById('results-title').textContent === 'Finished');
});

test('"run again" and "next scenario" take control first', async () => {
  await page.click('#run-again');
  await waitFor(() => server.chosen === 'made_up', 'the same again');
  await page.reload();
  await shows(page, '#run-next');
  await page.click('#run-next');
  await waitFor(() => server.chosen === 'made_up_too', 'the next');
});

test('while another page has control, nothing can be chosen', async () => {
  await page.reload();
  await shows(page, '#run-again');
  server.leases.control = 99;
  server.broadcast({type: 'leases', ...server.leaseMessage()});
  await until(page, () => document.getElementById('run-again').disabled);
  assert.ok(await page.locator('#run-next').isDisabled());
  server.leases.control = null;
  server.broadcast({type: 'leases', ...server.leaseMessage()});
  await until(page, () => !document.getElementById('run-again').disabled);
});

test('the report is saved', async () => {
  const download = page.waitForEvent('download');
  await page.click('#save-report');
  assert.match((await download).suggestedFilename(), /report\.html$/);
});

test('when the program ends, the results stay without the actions that need the program', async () => {
  await server.finish('The program was ended.');
  await until(page, () => window.predictor.phase() === 'ended');
  await shows(page, '#results-figures');
  for (const id of ['#run-again', '#run-next', '#save-report', '#emergency']) await shows(page, id, false);
  assert.equal(await page.locator('.state-card').getAttribute('data-tone'), 'calm');
});

// ---- a small window ----------------------------------------------------------------------------------

test('at 900 × 640, no button covers the scene, and everything fits', async () => {
  await fresh();
  const {scene, over, width, wrapped} = await page.evaluate(() => {
    const box = document.querySelector('.scene').getBoundingClientRect();
    const shown = [...document.querySelectorAll('button, select, input')].filter((e) => e.checkVisibility());
    const lies = (r) => r.left < box.right - 1 && r.right > box.left + 1 && r.top < box.bottom - 1 && r.bottom > box.top + 1;
    const tools = [...document.querySelectorAll('.tools button')].filter((e) => e.checkVisibility());
    return {
      scene: {width: box.width, height: box.height},
      over: shown.filter((e) => lies(e.getBoundingClientRect())).map((e) => e.id || e.textContent),
      width: document.documentElement.scrollWidth,
      wrapped: new Set(tools.map((e) => e.getBoundingClientRect().top)).size > 1,
    };
  });
  assert.deepEqual(over, []);
  assert.ok(width <= kSmall.width, `${width} px`);
  assert.ok(scene.height >= 340 && scene.width >= 560, JSON.stringify(scene));
  assert.equal(wrapped, false, 'the tools lie in one row');
  await screenshot(page, 'small');
});

test('no error was written to the console', () => {
  assert.deepEqual(ownProblems(page), []);
});
