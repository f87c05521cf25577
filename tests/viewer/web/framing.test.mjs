// Tests the camera's views that contain the body, by projecting points.
import assert from 'node:assert/strict';
import {createRequire} from 'node:module';
import {before, test} from 'node:test';
import {join} from 'node:path';
import {near, web} from './harness.mjs';

const esbuild = createRequire(join(web, 'package.json'))('esbuild');
const kTangent = Math.tan(Math.PI * 21 / 180);  // of half the field of view
let page;

before(async () => {
  const contents = `export * from './src/scene/framing'; export {PerspectiveCamera, Vector3} from 'three';`;
  const {outputFiles} = await esbuild.build({
    stdin: {contents, resolveDir: web, loader: 'ts'}, bundle: true, format: 'esm', write: false, logLevel: 'silent',
  });
  page = await import(`data:text/javascript,${encodeURIComponent(outputFiles[0].text)}`);
});

// Returns the points as a camera at that place sees them: from −1 to 1 across and upwards.
function seen(points, {eye, target}, aspect) {
  const camera = new page.PerspectiveCamera(42, aspect, 0.02, 40);
  camera.position.copy(eye);
  camera.lookAt(target);
  camera.updateMatrixWorld();
  return points.map((p) => p.clone().project(camera));
}

test('the view contains all points in its free part, and touches two opposite edges of this part', () => {
  const points = [[0, 0, 0], [0.9, 1.4, 0.2], [1.1, -0.6, -0.4], [-0.2, 0.8, 0.5]].map((p) => new page.Vector3(...p));
  const about = new page.Vector3(0.4, 0.3, 0.1), toEye = new page.Vector3(0.7, 0.7, 2.6).normalize();
  // A wide picture is limited by its height, a narrow one by its width.
  for (const [aspect, limited] of [[1.8, 'y'], [0.5, 'x']]) {
    const covered = {left: 0.3, top: 0.12};
    const place = page.frame(points, about, toEye, kTangent, aspect, covered);
    const at = seen(points, place, aspect);
    const edges = {x: [2 * covered.left - 1, 1], y: [-1, 1 - 2 * covered.top]};
    for (const axis of ['x', 'y']) {
      const values = at.map((p) => p[axis]);
      const ends = [Math.min(...values), Math.max(...values)];
      assert.ok(ends[0] > edges[axis][0] - 1e-9 && ends[1] < edges[axis][1] + 1e-9, `${axis}: ${ends}`);
      if (axis === limited) near(ends, edges[axis], 1e-9, `${axis} at ${aspect}`);
    }
    near(place.eye.clone().sub(place.target).normalize().toArray(), toEye.toArray(), 1e-12, 'direction');
  }
});

test('the points enclose the person, the cobot and the fixtures, but no plane', () => {
  const pose = (p, q = [1, 0, 0, 0]) => ({p, q});
  const spec = {
    viewpoint: {eye: [1, 0.1, 0.9], forward: [-1, 0, 0], ground: [1, 0.1, -0.7]}, cobot: {base: pose([0, 0, 0])},
    fixtures: [
      {shape: 'plane', size: [30, 30, 0], pose: pose([0, 0, -9])},
      // A lying cylinder, whose axis is along y.
      {shape: 'cylinder', size: [0.05, 3, 0], pose: pose([0.4, 0, 1.5], [Math.SQRT1_2, Math.SQRT1_2, 0, 0])},
    ],
  };
  const points = page.pointsToShow(spec, [0.5, 0, 0.4]);
  const ends = [0, 1, 2].map((k) => [Math.min(...points.map((p) => p[k])), Math.max(...points.map((p) => p[k]))]);
  near([ends[1][0], ends[1][1], ends[2][1]], [-1.5, 1.5, 1.55], 1e-9, 'the cylinder');
  assert.ok(ends[0][0] < 0 && ends[0][1] > 1.2, 'from behind the cobot to the person’s back');
  assert.equal(ends[2][0], -0.7);
});
