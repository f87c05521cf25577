// Reads Collada files quickly. Nearly all of such a file consists of long lists of numbers, on
// which the browser's XML parser would spend most of its time. Therefore this module extracts the
// lists and returns them as typed arrays.
import {Object3D, Texture} from 'three';
import {ColladaComposer} from 'three/examples/jsm/loaders/collada/ColladaComposer.js';
import {ColladaParser, Geometry} from 'three/examples/jsm/loaders/collada/ColladaParser.js';
import {parseNumbers} from './numbers';

const kLong = 400;       // longer lists are extracted [characters]
const kMark = -1234567;  // begins the placeholder of a list

export interface ColladaModel {
  scene: Object3D;
  textured: boolean;  // refers to textures, which are not shown
}

// Reads the model in the file's own axes, as URDF requires, and ignores which axis the file
// declares as up. Throws an Error if the file cannot be parsed.
export function parseCollada(text: string): ColladaModel {
  const lists: Float64Array[] = [];
  const parsed = /<COLLADA\b/.test(text) ? new ColladaParser().parse(takeOut(text, lists)) : null;
  if (!parsed) throw new Error('not a Collada file');
  const {library, asset, collada} = parsed;
  Object.values(library.geometries).forEach((geometry) => putBack(geometry, lists));
  let textured = false;
  const noTextures = {
    load: () => {
      textured = true;
      return new Texture();
    },
  };
  const {scene} = new ColladaComposer(library, collada, noTextures, noTextures).compose();
  scene.scale.multiplyScalar(asset.unit);
  return {scene, textured};
}

// Returns the text without the long lists of its geometries and appends these to `lists`.
function takeOut(text: string, lists: Float64Array[]): string {
  const from = Math.max(text.indexOf('<library_geometries'), 0);
  const to = text.lastIndexOf('</library_geometries');
  const short = text.slice(from, to).replace(
      /(<(?:float_array|p|vcount)\b[^>]*>)([^<]+)(?=<)/g, (all, tag: string, numbers: string) =>
        (numbers.length < kLong ? all : `${tag}${kMark} ${lists.push(parseNumbers(numbers)) - 1}`));
  return to < from ? text : text.slice(0, from) + short + text.slice(to);
}

function putBack({sources, primitives}: Geometry, lists: Float64Array[]) {
  const whole = (list: ArrayLike<number>) => (list[0] === kMark ? lists[list[1]] : list);
  for (const source of Object.values(sources)) source.array = whole(source.array);
  for (const primitive of primitives) {
    if (primitive.vcount) primitive.vcount = whole(primitive.vcount);
    if (!primitive.p) continue;
    primitive.p = whole(primitive.p);
    if (primitive.type === 'polygons') primitive.vcount = [primitive.p.length / primitive.stride];
  }
}
