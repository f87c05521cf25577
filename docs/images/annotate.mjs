// Draws the numbers of first-run.md on the picture of the page: node docs/images/annotate.mjs
// reads page.png and writes page-numbered.png. Needs a browser and web/node_modules (./dev test).
import {readFileSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const {chromium} = createRequire(join(here, '../../web/package.json'))('playwright-core');

// Centres of the numbers, beside the parts of the page [pixels].
const kNumbers = [
  [470, 22],   // 1 scenario and progress
  [640, 65],   // 2 views
  [176, 116],  // 3 instruction
  [312, 150],  // 4 the person
  [462, 330],  // 5 scene
  [346, 633],  // 6 plots
  [961, 89],   // 7 stop
  [961, 156],  // 8 state of the run
  [1142, 212],  // 9 commands
  [1142, 372],  // 10 people
  [1142, 497],  // 11 sliders
];
const kRadius = 15;

const picture = readFileSync(join(here, 'page.png'));
const [width, height] = [picture.readUInt32BE(16), picture.readUInt32BE(20)];
const marks = kNumbers.map(([x, y], i) =>
    `<circle cx="${x}" cy="${y}" r="${kRadius}" fill="#ffd21f" stroke="#000" stroke-width="2"/>` +
    `<text x="${x}" y="${y}" text-anchor="middle" dominant-baseline="central" font-family="sans-serif" ` +
    `font-weight="bold" font-size="17">${i + 1}</text>`);

const browser = await chromium.launch({
  executablePath: process.env.PREDICTOR_CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox'],
});
const page = await browser.newPage({viewport: {width, height}});
await page.setContent(
    `<body style="margin:0"><svg width="${width}" height="${height}" style="display:block">` +
    `<image href="data:image/png;base64,${picture.toString('base64')}" width="${width}" height="${height}"/>` +
    `${marks.join('')}</svg>`);
await page.waitForFunction(() => document.querySelector('image').getBBox().width > 0);
writeFileSync(join(here, 'page-numbered.png'), await page.screenshot());
await browser.close();
