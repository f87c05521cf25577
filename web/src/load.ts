// The colours of a load are the same as in reports (LoadColor in src/assessment): light green,
// amber, dark red. The colours become darker with the load, so that people who confuse red with
// green can distinguish them.

const kStops = [[0x8f, 0xd3, 0xb6], [0xf2, 0xa9, 0x1e], [0x9c, 0x0f, 0x2c]];
export const kNotJudged = 0xb9c2cd;

// `share` is the load relative to the largest load that a part can bear. Above a share of 1, the
// colour remains the same. The value null means that the part is not judged.
export function loadColor(share: number | null): number {
  if (share === null || Number.isNaN(share)) return kNotJudged;
  const x = 2 * Math.min(Math.max(share, 0), 1);
  const low = x < 1 ? 0 : 1;
  return kStops[low].reduce((color, from, k) =>
    256 * color + Math.round(from + (kStops[low + 1][k] - from) * (x - low)), 0);
}
