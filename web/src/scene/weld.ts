// Merges equal corners of triangles, which mesh files store separately. A headset or a computer
// without a graphics card then has to transform at most a third of the vertices.
import {BufferAttribute, BufferGeometry} from 'three';

const kFine = 1e5;    // steps per metre: 0.01 mm
const kCoarse = 500;  // steps of a normal's component

// Merges corners with equal position and normal. Geometries that already have an index, or that
// have relevant attributes other than positions and normals, are returned unchanged.
export function weld(geometry: BufferGeometry): BufferGeometry {
  const position = geometry.getAttribute('position');
  const normal = geometry.getAttribute('normal');
  if (geometry.index || !position || !normal || geometry.groups.length > 1) return geometry;
  const corners = position.count;
  const keys = new Int32Array(corners * 6);
  for (let i = 0; i < corners; i++) {
    for (let k = 0; k < 3; k++) {
      keys[6 * i + k] = Math.round(position.getComponent(i, k) * kFine);
      keys[6 * i + 3 + k] = Math.round(normal.getComponent(i, k) * kCoarse);
    }
  }
  const {index, firsts} = unique(keys, corners);
  const welded = new BufferGeometry();
  for (const [name, from] of [['position', position], ['normal', normal]] as const) {
    const values = new Float32Array(firsts.length * 3);
    firsts.forEach((corner, i) => {
      for (let k = 0; k < 3; k++) values[3 * i + k] = from.getComponent(corner, k);
    });
    welded.setAttribute(name, new BufferAttribute(values, 3));
  }
  welded.setIndex(new BufferAttribute(index, 1));
  return welded;
}

// Returns, for each row of six numbers, the index of the distinct row that equals it, and the first
// occurrence of each distinct row.
function unique(keys: Int32Array, rows: number): {index: Uint32Array; firsts: number[]} {
  const size = 1 << Math.ceil(Math.log2(rows * 2 + 1));
  const table = new Int32Array(size).fill(-1);  // open addressing; contains distinct rows
  const index = new Uint32Array(rows);
  const firsts: number[] = [];
  for (let row = 0; row < rows; row++) {
    let hash = 17;
    for (let k = 0; k < 6; k++) hash = Math.imul(hash ^ keys[6 * row + k], 0x9e3779b1) ^ (hash >>> 15);
    let slot = (hash >>> 0) & (size - 1);
    while (table[slot] >= 0 && !same(keys, firsts[table[slot]], row)) slot = (slot + 1) & (size - 1);
    if (table[slot] < 0) {
      table[slot] = firsts.length;
      firsts.push(row);
    }
    index[row] = table[slot];
  }
  return {index, firsts};
}

function same(keys: Int32Array, a: number, b: number): boolean {
  for (let k = 0; k < 6; k++) {
    if (keys[6 * a + k] !== keys[6 * b + k]) return false;
  }
  return true;
}
