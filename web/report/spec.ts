// The plots as the program describes them (src/report/plot.h), and the numbers they are of.

export interface Axis {
  title: string;
  unit: string;
  low: number | null;
  high: number | null;
  zero: boolean;
  log: boolean;
  least: number;
  categories: string[];
}

export interface SeriesSpec {
  label: string;
  kind: 'line' | 'path' | 'markers' | 'bars';
  color: number;
  style: 'solid' | 'dashed' | 'dotted';
  x: number;  // of a column
  y: number;
  error?: number;
  xDetail?: number;
  yDetail?: number;
  barWidth?: number;
}

export interface PanelSpec {
  title: string;
  y: Axis;
  range: [number, number];
  height: number;
  series: SeriesSpec[];
  limits: {value: number; label: string}[];
  marks: {x: number; y: number; label: string}[];
}

export interface PlotSpec {
  id: string;
  x: Axis;
  range: [number, number];
  equal: boolean;
  group: string;
  spans: {from: number; to: number; label: string}[];
  notes: {x: number; label: string}[];
  panels: PanelSpec[];
}

export interface Points {
  x: Float64Array;
  y: Float32Array;
}

const kMissing = 0;

function bytesOf(base64: string): Uint8Array {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

// As src/report/encode.h writes it. By multiplication, since a value may take more than 32 bits.
export function decode(bytes: Uint8Array, step: number, to: Float64Array | Float32Array) {
  let value = 0;
  let at = 0;
  for (let i = 0; i < to.length; ++i) {
    let code = 0;
    let weight = 1;
    let byte = bytes[at++];
    while (byte >= 128) {
      code += (byte - 128) * weight;
      weight *= 128;
      byte = bytes[at++];
    }
    code += byte * weight;
    if (code === kMissing) {
      to[i] = NaN;
      continue;
    }
    code -= 1;
    value += code % 2 === 0 ? code / 2 : -(code + 1) / 2;
    to[i] = value * step;
  }
}

function read<T extends Float64Array | Float32Array>(n: number, make: (count: number) => T): T {
  const element = document.getElementById(`data-${n}`)!;
  const to = make(Number(element.dataset.count));
  decode(bytesOf(element.textContent!), Number(element.dataset.step), to);
  return to;
}

const times = new Map<number, Float64Array>();

export function xColumn(n: number): Float64Array {
  let column = times.get(n);
  if (!column) times.set(n, column = read(n, (count) => new Float64Array(count)));
  return column;
}

export function yColumn(n: number): Float32Array {
  return read(n, (count) => new Float32Array(count));
}

// First place in the ascending x whose value is not below.
export function lowerBound(x: Float64Array, value: number): number {
  let low = 0;
  let high = x.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (x[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}

// Parts of a detailed column without a break: from one place to before another.
function partsOf(x: Float64Array): [number, number][] {
  const parts: [number, number][] = [];
  if (x.length < 2) return parts;
  let step = Infinity;
  for (let i = 1; i < Math.min(x.length, 100); ++i) step = Math.min(step, x[i] - x[i - 1]);
  // A break has a place of its own, half a step before the next part.
  let start = 0;
  for (let i = 1; i < x.length; ++i) {
    if (x[i] - x[i - 1] < 3 * Math.max(step, 1e-4)) continue;
    parts.push([start, i]);
    start = i;
  }
  parts.push([start, x.length]);
  return parts;
}

// The coarse line, with every sample where it is known.
export function merge(coarse: Points, detail: Points): Points {
  const parts = partsOf(detail.x);
  const pieces: [Points, number, number][] = [];
  let from = 0;
  for (const [start, end] of parts) {
    const to = lowerBound(coarse.x, detail.x[start]);
    if (to > from) pieces.push([coarse, from, to]);
    pieces.push([detail, start, end]);
    from = Math.max(from, lowerBound(coarse.x, detail.x[end - 1]));
  }
  if (from < coarse.x.length) pieces.push([coarse, from, coarse.x.length]);
  const count = pieces.reduce((sum, [, a, b]) => sum + b - a, 0);
  const all = {x: new Float64Array(count), y: new Float32Array(count)};
  let at = 0;
  for (const [points, a, b] of pieces) {
    all.x.set(points.x.subarray(a, b), at);
    all.y.set(points.y.subarray(a, b), at);
    at += b - a;
  }
  return all;
}

// Of the points in each `width` of x the lowest and the highest, in their order, and a break if there is one.
// By x, not by number: where every tick is kept beside rarer points, those must not be thinned for its sake.
export function thin({x, y}: Points, width: number): Points {
  const places: number[] = [];
  for (let start = 0, end = 0; start < x.length; start = end) {
    const bin = Math.floor(x[start] / width);
    let low = -1;
    let high = -1;
    let gap = -1;
    for (end = start; end < x.length && (end === start || Math.floor(x[end] / width) === bin); ++end) {
      if (Number.isNaN(y[end])) gap = end;
      else if (low < 0) low = high = end;
      else if (y[end] < y[low]) low = end;
      else if (y[end] > y[high]) high = end;
    }
    const kept = [low, high, gap].filter((i, k, all) => i >= 0 && all.indexOf(i) === k);
    places.push(...kept.sort((a, b) => a - b));
  }
  return {x: Float64Array.from(places, (i) => x[i]), y: Float32Array.from(places, (i) => y[i])};
}

// Smallest distance between neighbours in x; 0 if there is none.
export function spacing(x: Float64Array): number {
  let least = Infinity;
  for (let i = 1; i < x.length; ++i) {
    const step = x[i] - x[i - 1];
    if (step > 0 && step < least) least = step;
  }
  return Number.isFinite(least) ? least : 0;
}
