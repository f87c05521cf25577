// Tests the drawn part of a plot and the positions of its words. It runs the page's own code
// without a browser.
import assert from 'node:assert/strict';
import {createRequire} from 'node:module';
import {join} from 'node:path';
import {before, test} from 'node:test';
import {web} from '../../viewer/web/harness.mjs';

const esbuild = createRequire(join(web, 'package.json'))('esbuild');
let page;  // {Series, layOut, makeOption, draw, linearTicks, logTicks}

before(async () => {
  const {outputFiles} = await esbuild.build({
    stdin: {
      contents: `export * from './data'; export * from './option'; export * from './axis'; export {draw} from './drawing';`,
      resolveDir: join(web, 'report'), loader: 'ts',
    },
    bundle: true, format: 'esm', write: false, logLevel: 'silent',
  });
  page = await import(`data:text/javascript,${encodeURIComponent(outputFiles[0].text)}`);
});

const axis = (title, more = {}) => (
  {title, unit: '', low: null, high: null, zero: false, log: false, least: 0, names: [], first: 0, ...more});
const line = (label, more = {}) => ({label, kind: 'line', color: 0, style: 'solid', x: 0, y: 0, ...more});
const simple = () => ({
  id: 'simple', title: 'A & B', equal: false, group: '', x: axis('Time [s]'), spans: [],
  notes: [{x: 1, label: 'one'}, {x: 1.01, label: 'another beside it'}],
  panels: [{
    title: 'Force', height: 1, y: axis('Force [N]', {zero: true}), series: [line('left <1>')],
    limits: [{value: 30, label: 'stop above 30 N'}, {value: 500, label: 'far away'}],
  }],
});
const kPoints = {x: [0, 1, 2, 3], y: [0, 10, NaN, 20]};

// Returns the plot as SVG. `points` contains the points of every line.
function svgOf(plot, {x, y, ...more} = kPoints) {
  const others = Object.fromEntries(Object.entries(more).map(([name, values]) => [name, Float32Array.from(values)]));
  const series = plot.panels.map((panel) => panel.series.map(
      (spec) => new page.Series(spec, {x: Float64Array.from(x), y: Float32Array.from(y), ...others})));
  const whole = page.wholeX(plot, series);
  const layout = page.layOut({plot, series, x: whole, extent: whole, hidden: new Set(), width: 900, heading: true});
  return page.draw(layout, (name) => (name === 'c0' ? '#0072b2' : '#333'));
}

// Returns the words and their positions.
const wordsOf = (svg) => [...svg.matchAll(/<text([^>]*)>([^<]*)</g)].map(([, attributes, words]) => {
  const own = (name) => Number((attributes.match(new RegExp(` ${name}="([-0-9.]+)"`)) ?? [0, 0])[1]);
  const [, tx = 0, ty = 0] = attributes.match(/translate\(([-0-9.]+) ([-0-9.]+)\)/) ?? [];
  return {words, x: own('x') + Number(tx), y: own('y') + Number(ty)};
});
const placeOf = (svg, words) => wordsOf(svg).filter((one) => one.words === words);
// Returns the points of the data lines with this stroke colour.
const pathOf = (svg) => (svg.match(/<path d="([^"]*)"[^>]*stroke="#0072b2"/) ?? ['', ''])[1];
const pointsOf = (path) => [...path.matchAll(/(-?[0-9.]+)[ ,](-?[0-9.]+)/g)].map((m) => [Number(m[1]), Number(m[2])]);

test('a saved picture is well-formed XML', () => {
  const attributes = [...svgOf(simple()).matchAll(/<[a-z]+([^>]*)>/gi)].map((match) => match[1]);
  assert.ok(attributes.length > 20);
  for (const each of attributes) assert.match(each, /^(\s+[\w:-]+="[^"<]*")*\s*\/?$/);
});

test('a plot has units and limits, names are not markup, and a gap interrupts the line', () => {
  const svg = svgOf(simple());
  for (const words of ['Time [s]', 'Force [N]', 'stop above 30 N', 'left &lt;1&gt;', 'A &amp; B', 'far away ↑']) {
    assert.equal(placeOf(svg, words).length, 1, words);
  }
  assert.equal(pathOf(svg).match(/M/g).length, 2);
  assert.doesNotMatch(svg, /NaN|undefined/);
});

test('a legend that is too long is drawn in several rows', () => {
  const plot = simple();
  const [panel] = plot.panels;
  panel.series = Array.from({length: 8}, (_, k) => line(`bar_circle_2026-01-31_14-05-0${k}.mcap, right`));
  panel.series.push(line('x'.repeat(300)));
  const svg = svgOf(plot);
  const [, frame] = svg.match(/<path d="M66 ([0-9.]+)l820 0l0 170/);
  const words = wordsOf(svg).filter((one) => /mcap|xxx/.test(one.words));
  assert.equal(words.length, 9);
  const rows = new Map();
  for (const one of words.sort((a, b) => a.x - b.x)) {
    const end = one.x + 5.5 * one.words.length;  // a letter's mean width at 12 px
    assert.ok(one.x >= (rows.get(one.y) ?? 0), `${one.words} overlaps another text`);
    assert.ok(one.y < Number(frame), `${one.words} is inside the plot`);
    assert.ok(end <= 900 + 5, `${one.words} extends beyond the picture`);
    rows.set(one.y, end);
  }
  assert.ok(rows.size >= 4, `${rows.size} rows`);
});

test('no line crosses the text of a limit, and no texts overlap', () => {
  for (const apart of [0, 0.5, 1, 2, 4, 8]) {
    const plot = simple();
    plot.panels[0].limits = [{value: 10, label: 'first'}, {value: 10 + apart, label: 'second'}];
    const svg = svgOf(plot);
    const lines = [...svg.matchAll(/<path d="M66 ([-0-9.]+)L886 [-0-9.]+"[^>]*stroke-dasharray="7,4"/g)].map((m) => Number(m[1]));
    assert.equal(lines.length, 2, `${apart}`);
    const [first] = placeOf(svg, 'first');
    const [second] = placeOf(svg, 'second');
    assert.ok(Math.abs(first.y - second.y) >= 12, `${apart}: ${first.y} and ${second.y}`);
    for (const {words, y} of [first, second]) {
      for (const at of lines) assert.ok(Math.abs(at - y) >= 5, `${apart}: ${at} runs through "${words}" at ${y}`);
    }
  }
});

test('a note is beside its line on a logarithmic axis', () => {
  const plot = {...simple(), notes: [{x: 5, label: 'here'}], x: axis('Mass [kg]', {log: true, low: 1, high: 100})};
  const svg = svgOf(plot, {x: [1, 5, 20, 100], y: [0, 10, 15, 20]});
  const [note] = placeOf(svg, 'here');
  const bottom = placeOf(svg, '5').sort((a, b) => b.y - a.y)[0];  // the tick below the plot
  assert.ok(note.x >= bottom.x && note.x < bottom.x + 6, `${note.x}, tick at ${bottom.x}`);
});

test('notes that are close to each other are drawn in several rows', () => {
  const svg = svgOf(simple());
  assert.ok(Math.abs(placeOf(svg, 'one')[0].y - placeOf(svg, 'another beside it')[0].y) >= 14);
});

test('the drawing of a million points is small and keeps every spike', () => {
  const x = Array.from({length: 1_000_000}, (_, i) => 1e-3 * i);
  const plot = simple();
  plot.notes = [];
  plot.panels[0].limits = [];
  const svg = svgOf(plot, {x, y: x.map((t, i) => (i === 654_321 ? 50 : Math.sin(t)))});
  assert.ok(svg.length < 120_000, `${svg.length}`);
  const heights = pointsOf(pathOf(svg)).map(([, y]) => y).sort((a, b) => a - b);
  assert.ok(heights[1] - heights[0] > 100, 'the spike stands out');
});

test('a metre has the same length on both axes of a path', () => {
  const plot = {...simple(), equal: true, notes: [], x: axis('x [m]')};
  plot.panels = [{title: '', height: 1, y: axis('y [m]'), limits: [], series: [line('', {kind: 'path'})]}];
  const points = pointsOf(pathOf(svgOf(plot, {x: [0, 1, 1, 0, 0], y: [0, 0, 1, 1, 0]})));
  const size = (k) => Math.max(...points.map((p) => p[k])) - Math.min(...points.map((p) => p[k]));
  assert.ok(size(0) > 50);
  assert.ok(Math.abs(size(0) - size(1)) < 0.3, `${size(0)} × ${size(1)}`);
});

test('markers are at their values, with bars for known errors; values may have names', () => {
  const plot = {...simple(), notes: [], x: axis('Statement', {names: ['S1', 'S2', 'S3'], low: -0.5, high: 2.5})};
  plot.panels = [{
    title: '', height: 1, limits: [], series: [line('mean', {kind: 'markers', symbol: 'square'})],
    y: axis('Answer', {names: ['disagree (−1)', 'neither (0)', 'agree & more (1)'], first: -1, low: -1.5, high: 1.5}),
  }];
  const svg = svgOf(plot, {x: [0, 1, 2], y: [0, 1, NaN], error: [0.5, NaN, 1]});
  for (const words of ['S1', 'S3', 'disagree (−1)', 'neither (0)', 'agree &amp; more (1)', 'Answer']) {
    assert.equal(placeOf(svg, words).length, 1, words);
  }
  assert.equal(svg.match(/fill="#0072b2"/g).length, 2 + 1, 'two markers and the legend');
  assert.equal(svg.match(/stroke="#0072b2"/g).length, 3, 'one bar with its two ends');
  assert.doesNotMatch(svg, /NaN|undefined/);
  assert.ok(placeOf(svg, 'S1')[0].x < placeOf(svg, 'S2')[0].x);
  assert.ok(placeOf(svg, 'disagree (−1)')[0].y > placeOf(svg, 'neither (0)')[0].y);
});

test('an area lies between its edges, and a gap splits it', () => {
  const plot = {...simple(), notes: []};
  plot.panels[0].limits = [];
  plot.panels[0].series = [line('band', {kind: 'area'})];
  const svg = svgOf(plot, {x: [0, 1, 1, 2, 3], y: [2, 4, NaN, 4, 4], base: [1, 2, NaN, 2, 2]});
  const strips = [...svg.matchAll(/<polygon points="([^"]*)"[^>]*fill="#0072b2"/g)].map((m) => pointsOf(m[1]));
  assert.equal(strips.length, 2);
  const [[low1, high1, high2, low2]] = strips;
  assert.ok(low1[1] > high1[1] && low2[1] > high2[1] && high1[1] > high2[1], 'upwards is less');
  assert.doesNotMatch(svg, /NaN|undefined/);
});

test('tick labels are at round values', () => {
  assert.deepEqual(page.linearTicks({low: -0.2, high: 0.6}, 5).text, ['-0.2', '0.0', '0.2', '0.4', '0.6']);
  assert.deepEqual(page.logTicks({low: 8, high: 3000}, 10).text, ['10', '20', '50', '100', '200', '500', '1000', '2000']);
});
