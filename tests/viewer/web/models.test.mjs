// Tests models that cannot be displayed completely. The page must replace a missing mesh with a
// wire box and a message, and still show the rest of the robot.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {asker, launch, near, open, ready, screenshot, serve} from './harness.mjs';

const visual = (file, x) => `
  <visual>
    <origin xyz="${x} 0 0"/>
    <geometry><mesh filename="${file}"/></geometry>
    <material name="painted"><texture filename="paint.png"/></material>
  </visual>`;
const kTetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
const kFaces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

// The mesh is in millimetres and has Z up. A URDF uses the axes of the mesh file itself.
const kCollada = `<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="millimeter" meter="0.001"/><up_axis>Z_UP</up_axis></asset>
  <library_images><image id="wood"><init_from>wood.png</init_from></image></library_images>
  <library_effects><effect id="e"><profile_COMMON>
    <newparam sid="s"><surface type="2D"><init_from>wood</init_from></surface></newparam>
    <newparam sid="t"><sampler2D><source>s</source></sampler2D></newparam>
    <technique sid="common"><lambert><diffuse><texture texture="t" texcoord="UV"/></diffuse></lambert></technique>
  </profile_COMMON></effect></library_effects>
  <library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
  <library_geometries><geometry id="g"><mesh>
    <source id="p"><float_array id="pa" count="12">${
      kTetrahedron.flat().map((v) => (100 * v).toFixed(60)).join(' ')}</float_array>
      <technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
        <param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
    <triangles count="4" material="m"><input semantic="VERTEX" source="#v" offset="0"/>
      <p>${kFaces.flat().join(' ')}</p></triangles>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="scene"><node id="n"><instance_geometry url="#g">
    <bind_material><technique_common><instance_material symbol="m" target="#m"/></technique_common></bind_material>
  </instance_geometry></node></visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>`;

const kObject = {
  'model.urdf': `<robot name="object"><link name="body">
    ${visual('good.obj', 0.3)}${visual('long.dae', -0.3)}${visual('unknown.ply', 0)}
    ${visual('missing.stl', 0.1)}${visual('broken.dae', 0.2)}</link></robot>`,
  'good.obj': `mtllib none.mtl\n${kTetrahedron.map((v) => `v ${v.map((x) => 0.1 * x).join(' ')}`).join('\n')}
${kFaces.map((f) => `f ${f.map((i) => i + 1).join(' ')}`).join('\n')}\n`,
  'long.dae': kCollada,
  'broken.dae': 'not one',
};

let browser;
let server;
let page;

before(async () => {
  browser = await launch();
  server = await serve({light: true, object: kObject});
  server.frozen = true;
  page = await open(browser, server.url);
  await ready(page);
});

after(async () => {
  await browser?.close();
  await server?.close();
});

const predictor = asker(() => page);

test('valid meshes are shown in their places even if others cannot be shown', async () => {
  const box = await predictor('meshBox', 'object');
  const {p} = (await predictor('shown')).object;
  // The box must reach from the Collada file's tetrahedron at −0.3 m to that of the .obj file at
  // +0.3 m. Each is 0.1 m in size.
  near(box.min, [p[0] - 0.3, p[1], p[2]], 2e-3, 'least');
  near(box.max, [p[0] + 0.4, p[1] + 0.1, p[2] + 0.1], 2e-3, 'largest');
  assert.ok(await predictor('linkPose', 'panda_link8'), 'the cobot too');
});

test('a wire box replaces each mesh that cannot be shown, and a message stays', async () => {
  assert.equal(await predictor('placeholders'), 3);
  const text = await page.locator('#warning').textContent();
  for (const words of ['unknown.ply: a mesh is .dae, .stl or .obj', 'missing.stl: 404', 'not a Collada file',
                       'textures are not shown']) {
    assert.ok(text.includes(words), `${words}: ${text}`);
  }
  assert.equal(text.match(/textures are not shown/g).length, 1, 'once');
  await page.waitForTimeout(6000);
  assert.ok(await page.locator('#warning').isVisible());
  await screenshot(page, 'models');
  await page.click('#warning button');
  assert.equal(await page.locator('#warning').isVisible(), false);
});

test('the browser reports an error only for the missing mesh', () => {
  assert.equal(page.problems.length, 1, page.problems.join());
  assert.match(page.problems[0], /404/);
});
