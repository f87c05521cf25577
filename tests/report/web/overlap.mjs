// Checks every page: it must be drawn completely, and no words may overlap, not even on paper.
import assert from 'node:assert/strict';
import {until} from './files.mjs';

// Lists plots that are not drawn, and words that overlap others or leave their picture.
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
      if (p.left < frame.left - 1 || p.right > frame.right + 1) bad.push(`${figure.id}: "${a}" extends beyond the picture`);
      words.slice(i + 1).forEach(([b, q]) => {
        const w = Math.min(p.right, q.right) - Math.max(p.left, q.left);
        const h = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
        if (w > 1 && h > 3) bad.push(`${figure.id}: "${a}" over "${b}"`);
      });
    });
  }
  return bad;
});

// Prepares the page for printing and waits until all plots are drawn.
export async function printed(page) {
  await page.emulateMedia({media: 'print'});
  await until(page, () => [...document.querySelectorAll('figure.plot')].every((figure) => figure.querySelector('svg[viewBox]')));
}

// Opens a file in its printed form and asserts that it has no faults.
export async function assertPrints(browser, file) {
  const page = await browser.newPage({viewport: {width: 1000, height: 900}, colorScheme: 'dark'});
  await page.goto(`file://${file}`);
  await printed(page);
  assert.deepEqual(await faults(page), []);
  // No table may be wider than A4 paper with its margins.
  await page.setViewportSize({width: 688, height: 900});
  assert.deepEqual(await page.$$eval('table', (all) => all.filter((table) => {
    const {right} = table.getBoundingClientRect();
    return right > document.documentElement.clientWidth + 1 || table.scrollWidth > table.clientWidth + 1;
  }).map((table) => table.innerText.slice(0, 60))), []);
  return page;
}
