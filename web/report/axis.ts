// Computes the ends of axes and their tick labels.
import {Axis, Range} from './data';

const kPadding = 0.1;   // share of the range above and below the data: room for a limit's label
const kLimitReach = 3;  // a limit farther away than this multiple of the data's range is not shown

export interface Ticks {
  at: number[];
  text: string[];
}

// Formats a value. The label of zero never has a minus sign.
function fixed(value: number, decimals: number): string {
  const text = value.toFixed(decimals);
  return /^-[0.]*$/.test(text) ? text.slice(1) : text;
}

function roundStep(rough: number): number {
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * ([1, 2, 5].find((step) => rough <= step * power * (1 + 1e-9)) ?? 10);
}

export function linearTicks({low, high}: Range, count: number): Ticks {
  const step = roundStep((high - low) / Math.max(1, count));
  const decimals = Math.min(Math.max(Math.ceil(-Math.log10(step) - 1e-9), 0), 9);
  const at: number[] = [];
  for (let k = Math.ceil(low / step - 1e-9); k <= Math.floor(high / step + 1e-9); ++k) at.push(k * step);
  return {at, text: at.map((value) => fixed(value, decimals))};
}

// Returns powers of ten. If there is room, it also returns 2 and 5 times these powers.
export function logTicks({low, high}: Range, count: number): Ticks {
  const decades = Math.log10(high / low);
  const factors = 3 * decades <= count ? [1, 2, 5] : [1];
  const every = Math.max(1, Math.ceil(decades / Math.max(1, count)));
  const at: number[] = [];
  const text: string[] = [];
  for (let p = Math.floor(Math.log10(low)); 10 ** p <= high; ++p) {
    if (p % every !== 0) continue;
    for (const factor of factors) {
      const value = factor * 10 ** p;
      if (value < low || value > high) continue;
      at.push(value);
      text.push(fixed(value, Math.max(0, -p)));
    }
  }
  // If the view shows less than a decade, the ticks are round numbers within this decade.
  return at.length >= 2 ? {at, text} : linearTicks({low, high}, count);
}

export function ticksOf(axis: Axis, range: Range, count: number): Ticks {
  if (axis.names.length > 0) return {at: axis.names.map((_, i) => axis.first + i), text: axis.names};
  return axis.log ? logTicks(range, count) : linearTicks(range, count);
}

// `limits` are values that the axis includes if they are near enough to the data.
export function yRange(axis: Axis, data: Range, limits: number[]): Range {
  let {low, high} = data;
  if (!(low <= high)) [low, high] = axis.log ? [1, 10] : [0, 1];
  if (axis.zero && !axis.log) [low, high] = [Math.min(low, 0), Math.max(high, 0)];
  const reach = kLimitReach * Math.max(high - low, axis.least);
  const near = limits.filter((value) => value <= high + reach && value >= low - reach);
  low = Math.min(low, ...near);
  high = Math.max(high, ...near);
  if (axis.log) {
    low /= 1.5;
    high *= 1.5;
  } else {
    const least = Math.max(axis.least, 1e-9 * Math.max(1, Math.abs(high)));
    if (high - low < least) {
      const middle = axis.zero && low === 0 ? least / 2 : (low + high) / 2;
      [low, high] = [middle - least / 2, middle + least / 2];
    }
    const length = high - low;
    if (!(axis.zero && low === 0)) low -= kPadding * length;
    if (!(axis.zero && high === 0)) high += kPadding * length;
  }
  return {low: axis.low ?? low, high: axis.high ?? high};
}

// Formats a value under the cursor, with three significant digits more than its unit needs.
export function readable(value: number): string {
  if (!Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size === 0) return '0';
  if (size >= 1e5) return value.toFixed(0);
  return fixed(value, Math.min(Math.max(3 - Math.floor(Math.log10(size)), 0), 6));
}
