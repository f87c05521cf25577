// Reads the plots with their data, in the form in which the program describes them
// (src/report/plot.h).

export interface Axis {
  title: string;
  unit: string;
  low: number | null;
  high: number | null;
  zero: boolean;
  log: boolean;
  least: number;
  names: string[];  // labels of the values first, first + 1, ...; replace numbers on the axis
  first: number;
}

export interface SeriesSpec {
  label: string;
  kind: 'line' | 'path' | 'markers' | 'bars' | 'area';
  color: number;
  style: 'solid' | 'dashed' | 'dotted';
  x: number;  // of a column
  y: number;
  xDetail?: number;
  yDetail?: number;
  barWidth?: number;
  base?: number;   // of an area: its lower edge
  error?: number;  // of markers: half the length of their bars
  symbol?: 'dot' | 'ring' | 'diamond' | 'hollow diamond' | 'triangle' | 'square' | 'cross' | 'plus';
}

export interface PanelSpec {
  title: string;
  y: Axis;
  height: number;
  series: SeriesSpec[];
  limits: {value: number; label: string}[];
}

export interface PlotSpec {
  id: string;
  title: string;
  x: Axis;
  equal: boolean;
  group: string;
  spans: {from: number; to: number; label: string}[];
  notes: {x: number; label: string}[];
  panels: PanelSpec[];
}

export interface Points {
  x: Float64Array;
  y: Float32Array;
  base?: Float32Array;
  error?: Float32Array;
}

const kMissing = 0;

function bytesOf(base64: string): Uint8Array {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

// Decodes numbers in the format that src/report/page.h describes. This function multiplies instead
// of shifting, since a value may need more than 32 bits.
function decode(bytes: Uint8Array, step: number, to: Float64Array | Float32Array) {
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

function xColumn(n: number): Float64Array {
  let column = times.get(n);
  if (!column) times.set(n, column = read(n, (count) => new Float64Array(count)));
  return column;
}

function yColumn(n: number): Float32Array {
  return read(n, (count) => new Float32Array(count));
}

// Returns the index of the first element of the ascending x that is not below `value`.
function lowerBound(x: Float64Array, value: number): number {
  let low = 0;
  let high = x.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (x[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}

// Returns the parts of a detailed column without gaps, as start index and end index (exclusive).
function partsOf(x: Float64Array): [number, number][] {
  const parts: [number, number][] = [];
  if (x.length < 2) return parts;
  let step = Infinity;
  for (let i = 1; i < Math.min(x.length, 100); ++i) step = Math.min(step, x[i] - x[i - 1]);
  // A gap is represented by its own point, half a step before the next part.
  let start = 0;
  for (let i = 1; i < x.length; ++i) {
    if (x[i] - x[i - 1] < 3 * Math.max(step, 1e-4)) continue;
    parts.push([start, i]);
    start = i;
  }
  parts.push([start, x.length]);
  return parts;
}

// Returns the coarse line. In the parts for which all samples are available, it contains all
// samples.
function merge(coarse: Points, detail: Points): Points {
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

// Keeps the lowest and the highest point in each interval of length `width` along x, in their
// original order, and preserves any gap in the interval. The bins are ranges of x, not numbers of
// points. If the bins had a fixed number of points, a line with a section that contains every tick
// would lose points in its sparse sections.
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

// Returns the smallest distance between neighbouring values of x, or 0 if all are equal.
export function spacing(x: Float64Array): number {
  let least = Infinity;
  for (let i = 1; i < x.length; ++i) {
    const step = x[i] - x[i - 1];
    if (step > 0 && step < least) least = step;
  }
  return Number.isFinite(least) ? least : 0;
}

// Reads the series from the page.
export function readSeries(spec: SeriesSpec): Series {
  const coarse: Points = {x: xColumn(spec.x), y: yColumn(spec.y)};
  if (spec.base !== undefined) coarse.base = yColumn(spec.base);
  if (spec.error !== undefined) coarse.error = yColumn(spec.error);
  if (spec.xDetail === undefined || spec.yDetail === undefined) return new Series(spec, coarse);
  return new Series(spec, merge(coarse, {x: xColumn(spec.xDetail), y: yColumn(spec.yDetail)}));
}

const kWider = 4;        // bin width of a level relative to the previous level
const kMaxSeen = 20000;  // maximum of visible points of a level: few enough to be thinned at each zoom step

export interface Range {
  low: number;
  high: number;
}

// A line with all its points, from which a view obtains the part that it shows.
export class Series {
  private readonly levels: Points[];  // each in bins four times as wide as in the previous level

  constructor(readonly spec: SeriesSpec, readonly points: Points) {
    this.levels = [points];
    let width = kWider * spacing(points.x);
    if (spec.kind !== 'line' || width === 0) return;
    while (this.levels.at(-1)!.x.length > kMaxSeen) {
      this.levels.push(thin(this.levels.at(-1)!, width));
      width *= kWider;
    }
  }

  // Returns the points between two values of x, plus one point on either side. For a line, the
  // function returns only the lowest and the highest point of each of `bins` parts.
  view({low, high}: Range, bins: number): Points {
    if (this.spec.kind !== 'line') return this.points;
    let part = this.points;
    for (const {x, y} of this.levels) {
      const from = Math.max(lowerBound(x, low) - 1, 0);
      const to = Math.min(lowerBound(x, high) + 1, x.length);
      part = {x: x.subarray(from, to), y: y.subarray(from, to)};
      if (to - from <= kMaxSeen) break;
    }
    return part.x.length <= 2 * bins ? part : thin(part, (high - low) / bins);
  }

  // Returns the value at x. For a line, this is the value of the preceding sample, or NaN in a gap.
  // For other series, this is the value of the nearest point, or NaN if that point is farther away
  // than `reach`.
  at(x: number, reach: number): number {
    const {points, spec} = this;
    const i = lowerBound(points.x, x);
    if (spec.kind === 'line') return points.y[points.x[i] === x ? i : i - 1] ?? NaN;
    const near = i > 0 && !(points.x[i] - x <= x - points.x[i - 1]) ? i - 1 : i;
    return spec.kind === 'bars' || Math.abs(points.x[near] - x) <= reach ? points.y[near] : NaN;
  }
}
