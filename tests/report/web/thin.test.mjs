// Tests, without a browser, which points of a long line are drawn.
import assert from 'node:assert/strict';
import {createRequire} from 'node:module';
import {before, test} from 'node:test';
import {join} from 'node:path';
import {web} from '../../viewer/web/harness.mjs';

const esbuild = createRequire(join(web, 'package.json'))('esbuild');
let spec;

before(async () => {
  const {outputFiles} = await esbuild.build({
    entryPoints: [join(web, 'report/data.ts')], bundle: true, format: 'esm', write: false, logLevel: 'silent',
  });
  spec = await import(`data:text/javascript,${encodeURIComponent(outputFiles[0].text)}`);
});

const wave = (x) => Math.sin(2 * Math.PI * x);
const line = (x) => ({x: Float64Array.from(x), y: Float32Array.from(x, wave)});
const inside = ({x}, from, to) => [...x].filter((v) => v >= from && v < to).length;

test('isolated points are kept among a thousand others', () => {
  const coarse = Array.from({length: 400}, (_, i) => i / 40 + 1 / 80);
  const dense = Array.from({length: 5000}, (_, i) => 10 + i / 1000);
  const points = line([...coarse, ...dense]);
  assert.ok(Math.abs(spec.spacing(points.x) - 0.001) < 1e-9);
  const thinned = spec.thin(points, 0.016);
  assert.equal(inside(thinned, 0, 10), 400);
  assert.ok(inside(thinned, 10, 15) <= 2 * (5 / 0.016 + 2));
});

test('the extremes of each bin are kept in their order, and gaps are kept', () => {
  const {x, y} = line(Array.from({length: 1000}, (_, i) => i / 1000));
  y[500] = NaN;
  const thinned = spec.thin({x, y}, 0.05);
  for (let bin = 0; bin < 20; bin++) {
    const of = ({x: at, y: values}) => [...values].filter((v, i) => Math.floor(at[i] / 0.05) === bin && !Number.isNaN(v));
    assert.equal(Math.max(...of(thinned)), Math.max(...of({x, y})));
    assert.equal(Math.min(...of(thinned)), Math.min(...of({x, y})));
  }
  assert.ok([...thinned.x].every((v, i, all) => i === 0 || v > all[i - 1]));
  assert.equal([...thinned.y].filter(Number.isNaN).length, 1);
});

test('lines whose points coincide, or without points, have no spacing', () => {
  assert.equal(spec.spacing(Float64Array.from([2, 2, 2])), 0);
  assert.equal(spec.spacing(new Float64Array(0)), 0);
  assert.equal(spec.thin({x: new Float64Array(0), y: new Float32Array(0)}, 1).x.length, 0);
});
