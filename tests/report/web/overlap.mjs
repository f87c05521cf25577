// What every page of ours must be: drawn in full, with no words over others, on paper as well.
import assert from 'node:assert/strict';

// Plots that are not drawn, and words over others or outside of their picture.
export const faults = (page) => page.evaluate(() => {
  const bad = [];
  for (const figure of document.querySelectorAll('figure.plot')) {
    const svg = figure.querySelector('svg');
    if (!svg || svg.getBoundingClientRect().height < 80) {
      bad.push(`${figure.id}: not drawn`);
      continue;
    }
    const frame = svg.getBoundingClientRect();
    const words = [...figure.querySelectorAll('text')].map((t) => [t.textContent, t.getBoundingClientRect()]);
    words.forEach(([a, p], i) => {
      if (p.left < frame.left - 1 || p.right > frame.right + 1) bad.push(`${figure.id}: "${a}" sticks out`);
      words.slice(i + 1).forEach(([b, q]) => {
        const w = Math.min(p.right, q.right) - Math.max(p.left, q.left);
        const h = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
        if (w > 1 && h > 3) bad.push(`${figure.id}: "${a}" over "${b}"`);
      });
    });
  }
  return bad;
});

// Opens a file as it is printed, without scripts, and looks for faults.
export async function assertPrints(browser, file) {
  const context = await browser.newContext(
      {viewport: {width: 1000, height: 900}, colorScheme: 'dark', javaScriptEnabled: false});
  const page = await context.newPage();
  await page.goto(`file://${file}`);
  await page.emulateMedia({media: 'print'});
  assert.deepEqual(await faults(page), []);
  // On A4 with its margins no table is wider than the paper.
  await page.setViewportSize({width: 688, height: 900});
  assert.deepEqual(await page.$$eval('table', (all) => all.filter((table) => {
    const {right} = table.getBoundingClientRect();
    return right > document.documentElement.clientWidth + 1 || table.scrollWidth > table.clientWidth + 1;
  }).map((table) => table.innerText.slice(0, 60))), []);
  return page;
}
