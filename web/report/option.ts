// Converts a view of a plot to the charting library's description, with panels in a column that
// share one x-axis.
import {format} from 'echarts/core';
import {Ticks, ticksOf, yRange} from './axis';
import {Axis, PanelSpec, PlotSpec, Range, Series, SeriesSpec} from './data';

// [px]
const kLeft = 66;     // minimum: named values may need more
const kRight = 14;
const kTop = 4;
const kBottom = 40;
const kHeight = 170;  // of a panel of height 1
const kRow = 18;      // of text
const kGap = 12;
const kKey = 30;      // of a line sample in the legend
// The quotation marks are single, because ECharts does not escape double quotation marks in a saved
// SVG.
const kFont = "system-ui, 'Segoe UI', Helvetica, Arial, sans-serif";
const kKeys = {
  solid: 'path://M0 0L22 0L22 3L0 3Z', dashed: 'path://M0 0L9 0L9 3L0 3ZM13 0L22 0L22 3L13 3Z',
  dotted: 'path://M0 0L4 0L4 3L0 3ZM9 0L13 0L13 3L9 3ZM18 0L22 0L22 3L18 3Z',
};
const kSymbols = {
  dot: 'circle', ring: 'emptyCircle', diamond: 'diamond', 'hollow diamond': 'emptyDiamond', triangle: 'triangle',
  square: 'path://M0 0L10 0L10 10L0 10Z',
  cross: 'path://M2 0L10 8L18 0L20 2L12 10L20 18L18 20L10 12L2 20L0 18L8 10L0 2Z',
  plus: 'path://M8.5 0L11.5 0L11.5 8.5L20 8.5L20 11.5L11.5 11.5L11.5 20L8.5 20L8.5 11.5L0 11.5L0 8.5L8.5 8.5Z',
};
// [px]
const kSizes = {cross: 7, plus: 8, dot: 9, ring: 9, square: 8, triangle: 11, diamond: 12, 'hollow diamond': 12};
const kThin = 0.16;  // opacity of an area
const kDashes = {solid: 'solid', dashed: [6, 3], dotted: [2, 2.5]};

export type Colors = (name: string) => string;

export interface View {
  plot: PlotSpec;
  series: Series[][];  // by panel
  x: Range;
  extent: Range;        // complete range of x
  hidden: Set<string>;  // names of series
  width: number;        // [px]
  heading: boolean;     // with the plot's title, for a separate picture
}

interface Entry {
  name: string;
  width: number;
  series: Series;
}

interface Panel {
  spec: PanelSpec;
  series: Series[];
  y: Range;
  far: string;  // limits outside the view
  rows: Entry[][];
  top: number;  // of its title
  grid: {left: number; top: number; width: number; height: number};
}

interface Note {
  x: number;
  label: string;
  left: number;
  row: number;
}

export interface Layout {
  view: View;
  x: Range;  // with equal axes, wider than the view's range
  panels: Panel[];
  notes: Note[];
  noteTop: number;
  height: number;
}

export const seriesName = (panel: number, series: Series) => `${panel} ${series.spec.label}`;
const labelOf = (name: string) => name.slice(name.indexOf(' ') + 1);
const widthOf = (text: string) => format.getTextRect(text, `12px ${kFont}`).width;

export function wholeX(plot: PlotSpec, series: Series[][]): Range {
  let [low, high] = [Infinity, -Infinity];
  for (const {points: {x}} of series.flat()) {
    for (const value of x) {
      if (!Number.isFinite(value) || (plot.x.log && value <= 0)) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (!(low < high)) [low, high] = Number.isFinite(low) ? [low - 0.5, low + 0.5] : [0, 1];
  const padding = plot.equal ? 0.04 * (high - low) : 0;
  return {low: plot.x.low ?? low - padding, high: plot.x.high ?? high + padding};
}

// Returns the range of the data of a panel's visible lines within the view.
function dataRange(view: View, panel: number): Range {
  const {log} = view.plot.panels[panel].y;
  let [low, high] = [Infinity, -Infinity];
  for (const series of view.series[panel]) {
    if (view.hidden.has(seriesName(panel, series))) continue;
    const {x, y, base = y, error} = series.view(view.x, view.width);
    for (let i = 0; i < x.length; ++i) {
      if (x[i] < view.x.low || x[i] > view.x.high || !Number.isFinite(y[i]) || (log && y[i] <= 0)) continue;
      low = Math.min(low, base[i] - (error?.[i] || 0));
      high = Math.max(high, y[i] + (error?.[i] || 0));
    }
  }
  return {low, high};
}

// Distributes the legend entries to rows. The first row is next to the title if all entries fit
// there.
function legendRows(panel: number, series: Series[], title: string, room: number): Entry[][] {
  const entries = series.filter(({spec}) => spec.label !== '').map((one) => ({
    name: seriesName(panel, one), series: one, width: Math.min(kKey + widthOf(one.spec.label) + 12, room)}));
  const beside = room - widthOf(title) - 16;
  if (entries.reduce((sum, {width}) => sum + width, 0) <= beside) return [entries];
  const rows: Entry[][] = [[], []];
  let left = room;
  for (const entry of entries) {
    if (entry.width > left) {
      rows.push([]);
      left = room;
    }
    rows.at(-1)!.push(entry);
    left -= entry.width;
  }
  return rows;
}

// Returns the horizontal position and width of the panels [px].
function frameOf({plot, width}: View): {left: number; width: number} {
  const names = plot.panels.flatMap(({y}) => y.names.map(widthOf));
  const left = Math.max(kLeft, ...names.map((name) => name + 34));
  return {left, width: width - left - kRight};
}

// Returns the position of x as a share of the axis, from 0 to 1.
function shareOf(x: number, {low, high}: Range, log: boolean): number {
  return log ? Math.log(x / low) / Math.log(high / low) : (x - low) / (high - low);
}

// Distributes the notes to rows above the first panel, so that no two overlap in a row.
function placeNotes(view: View, {low, high}: Range): Note[] {
  const {plot} = view;
  const frame = frameOf(view);
  const ends: number[] = [];
  return plot.notes.filter(({x}) => x >= low && x <= high).map(({x, label}) => {
    const width = widthOf(label) + 8;
    const at = frame.left + shareOf(x, {low, high}, plot.x.log) * frame.width;
    const left = Math.max(frame.left, Math.min(at + 3, frame.left + frame.width - width));
    let row = ends.findIndex((end) => end <= left);
    if (row < 0) row = ends.push(0) - 1;
    ends[row] = left + width;
    return {x, label, left, row};
  });
}

// Widens the range of x or y, so that a metre has the same length in both directions. Returns the
// height.
function fitEqual(x: Range, y: Range, width: number): number {
  const [dx, dy] = [x.high - x.low, y.high - y.low];
  const height = Math.min(Math.max(dy / dx * width, 120), 0.62 * width);
  const perPx = Math.max(dx / width, dy / height);
  for (const [range, missing] of [[x, perPx * width - dx], [y, perPx * height - dy]] as const) {
    range.low -= missing / 2;
    range.high += missing / 2;
  }
  return height;
}

export function layOut(view: View): Layout {
  const {plot} = view;
  const notes = placeNotes(view, view.x);
  const x = {...view.x};
  const noteTop = view.heading ? 26 : kTop;
  const {left, width} = frameOf(view);
  // Reserves the rows that the complete view needs, so that the plot does not move during a zoom.
  const rows = [...notes, ...placeNotes(view, view.extent)].map(({row}) => row + 1);
  let top = noteTop + kRow * Math.max(0, ...rows);
  const panels = plot.panels.map((spec, i) => {
    const y = yRange(spec.y, dataRange(view, i), spec.limits.map(({value}) => value));
    const far = spec.limits.filter(({value}) => value < y.low || value > y.high)
        .map(({value, label}) => `${label} ${value > y.high ? '↑' : '↓'}`).join(', ');
    const keys = legendRows(i, view.series[i], `${spec.title}   ${far}`, width);
    const height = plot.equal ? fitEqual(x, y, width) : kHeight * spec.height;
    const grid = {left, top: top + kRow * keys.length + 4, width, height};
    const panel = {spec, series: view.series[i], y, far, rows: keys, top, grid};
    top = grid.top + height + kGap;
    return panel;
  });
  return {view, x, panels, notes, noteTop, height: top - kGap + kBottom};
}

function axisOption(axis: Axis, {low, high}: Range, ticks: Ticks, color: Colors, labelled: boolean, gap: number) {
  return {
    type: axis.log ? 'log' : 'value', min: low, max: high,
    name: labelled ? axis.title : '', nameLocation: 'middle', nameGap: gap,
    nameTextStyle: {color: color('ink')}, nameMoveOverlap: false,
    axisLine: {show: false},
    axisTick: {show: false, customValues: ticks.at},
    axisLabel: {
      show: labelled, color: color('quiet'), customValues: ticks.at, hideOverlap: true,
      formatter: (value: number) => (
        ticks.text[ticks.at.findIndex((at) => Math.abs(at - value) <= 1e-9 * Math.abs(at))] ?? '0'),
    },
    splitLine: {show: true, showMinLine: true, showMaxLine: true, lineStyle: {color: color('grid')}},
  };
}

// Draws bars, or strips of an area, each between two values of x.
function stripsOption(strips: number[][], opacity: number) {
  const renderItem = (_: unknown, api: any) => {
    const [x1, x2, low1, high1, low2, high2] = [0, 1, 2, 3, 4, 5].map((i) => api.value(i));
    const points = [[x1, low1], [x1, high1], [x2, high2], [x2, low2]].map((point) => api.coord(point));
    return {type: 'polygon', shape: {points}, style: {fill: api.visual('color'), opacity}};
  };
  return {
    type: 'custom', renderItem, encode: {x: [0, 1], y: [2, 3, 4, 5]},
    data: strips.filter((strip) => strip.every(Number.isFinite)),
  };
}

function barsOption({spec, points: {x, y}}: Series, log: boolean, base: number) {
  const width = spec.barWidth ?? 0.8;
  return stripsOption(Array.from(x, (at, i) => [
    ...(log ? [at / width ** 0.5, at * width ** 0.5] : [at - width / 2, at + width / 2]), base, y[i], base, y[i]]), 1);
}

function areaOption({points: {x, y, base}}: Series) {
  return stripsOption(
      Array.from(x.subarray(1), (at, i) => [x[i], at, base![i], y[i], base![i + 1], y[i + 1]]), kThin);
}

function drawErrorBar(_: unknown, api: any) {
  const [x, high] = api.coord([api.value(0), api.value(1)]);
  const [, low] = api.coord([api.value(0), api.value(2)]);
  const line = (x1: number, y1: number, x2: number, y2: number) => (
    {type: 'line', shape: {x1, y1, x2, y2}, style: {stroke: api.visual('color'), lineWidth: 1.6}});
  return {type: 'group', children: [
    line(x, low, x, high), line(x - 4, low, x + 4, low), line(x - 4, high, x + 4, high)]};
}

// The bars belong to the same series as the markers, so that the legend hides both.
function errorsOption(series: Series) {
  const {x, y, error} = series.points;
  return {
    type: 'custom', renderItem: drawErrorBar, encode: {x: 0, y: [1, 2]},
    data: Array.from(x, (at, i) => [at, y[i] + error![i], y[i] - error![i]])
        .filter((bar) => bar.every(Number.isFinite)),
  };
}

function markersOption({spec, points: {x, y}}: Series, color: string) {
  const symbol = spec.symbol ?? 'dot';
  return {
    type: 'scatter', symbol: kSymbols[symbol], symbolSize: kSizes[symbol],
    itemStyle: {color, borderWidth: 2, opacity: 1},
    data: Array.from(x, (at, i) => [at, y[i]]).filter((point) => point.every(Number.isFinite)),
  };
}

function lineOption(series: Series, {view, panels: [{grid}]}: Layout, log: boolean, color: string) {
  const {x, y} = series.view(view.x, grid.width);
  const data = new Float64Array(2 * x.length);
  for (let i = 0; i < x.length; ++i) {
    data[2 * i] = x[i];
    data[2 * i + 1] = log && y[i] <= 0 ? NaN : y[i];
  }
  return {
    type: 'line', showSymbol: false, connectNulls: false, dimensions: ['x', 'y'], data,
    lineStyle: {width: 1.4, type: kDashes[series.spec.style], color},
  };
}

function seriesOption(layout: Layout, i: number, series: Series, color: Colors): object[] {
  const {view: {plot}, panels} = layout;
  const own = color(`c${series.spec.color}`);
  const {spec, y} = panels[i];
  const common = {
    id: `${i}-${panels[i].series.indexOf(series)}`, name: seriesName(i, series), color: own, clip: true,
    xAxisIndex: i, yAxisIndex: i, silent: true, animation: false, emphasis: {disabled: true},
  };
  switch (series.spec.kind) {
    case 'bars': return [{...common, ...barsOption(series, plot.x.log, Math.max(y.low, 0))}];
    case 'area': return [{...common, ...areaOption(series)}];
    case 'markers': return [
      ...(series.points.error ? [{...common, id: `${common.id}-error`, ...errorsOption(series)}] : []),
      {...common, ...markersOption(series, own)}];
    default: return [{...common, ...lineOption(series, layout, spec.y.log, own)}];
  }
}

// Returns the position of a limit's label. The label is above the limit's line, or below this line
// if another line is close above.
function limitSide(value: number, index: number, {spec, y, grid}: Panel): string {
  const room = 2.2 * kRow / grid.height * (y.high - y.low);
  const above = spec.limits.some((other, k) => k !== index &&
      (other.value > value || (other.value === value && k < index)) && other.value - value < room);
  return above ? 'insideEndBottom' : 'insideEndTop';
}

// Returns the limits, notes and shaded parts of a panel, as a series without points.
function marksOption(layout: Layout, i: number, color: Colors) {
  const {view: {plot, x}, panels} = layout;
  const panel = panels[i];
  const rim = {textBorderColor: color('surface'), textBorderWidth: 3, fontSize: 12};
  const limits = panel.spec.limits.map(({value, label}, k) => ({
    yAxis: value, lineStyle: {color: color('limit'), type: [7, 4], width: 1},
    label: {...rim, show: true, color: color('limit'), position: limitSide(value, k, panel), formatter: () => label},
  })).filter(({yAxis}) => yAxis >= panel.y.low && yAxis <= panel.y.high);
  const notes = layout.notes.map((note) => ({
    xAxis: note.x, lineStyle: {color: color('quiet'), type: [3, 3], width: 1}, label: {show: false}}));
  const spans = plot.spans.map(({from, to, label}) => ({
    label, from: Math.max(from, x.low), to: Math.min(to, x.high)})).filter(({from, to}) => from < to);
  const fits = (from: number, to: number, label: string) =>
      (shareOf(to, x, plot.x.log) - shareOf(from, x, plot.x.log)) * panel.grid.width > widthOf(label) + 6;
  return {
    id: `marks-${i}`, type: 'line', data: [], xAxisIndex: i, yAxisIndex: i, silent: true, animation: false,
    markLine: {symbol: 'none', silent: true, animation: false, data: [...limits, ...notes]},
    markArea: {
      silent: true, animation: false, itemStyle: {color: color('shade')},
      data: spans.map(({from, to, label}) => [
        {xAxis: from, label: {...rim, show: i === 0 && fits(from, to, label), color: color('quiet'),
                              position: 'insideTop', formatter: () => label}},
        {xAxis: to}]),
    },
  };
}

function keyOf({kind, style, symbol}: SeriesSpec): string {
  if (kind === 'bars' || kind === 'area') return 'rect';
  return kind === 'markers' ? kSymbols[symbol ?? 'dot'] : kKeys[style];
}

function legendOptions({panels, view}: Layout, color: Colors) {
  const selected = Object.fromEntries([...view.hidden].map((name) => [name, false]));
  return panels.flatMap(({rows, top, grid}) => rows.map((row, k) => ({
    top: top + kRow * k, padding: 0, itemGap: 12, itemWidth: kKey - 8, itemHeight: 9, selected,
    ...(rows.length > 1 ? {left: grid.left} : {right: kRight}),
    data: row.map(({name, series: {spec}}) => (
      {name, icon: keyOf(spec), itemStyle: {opacity: spec.kind === 'area' ? 2 * kThin : 1}})),
    formatter: (name: string) => format.truncateText(labelOf(name), grid.width - kKey, `12px ${kFont}`, '…'),
    textStyle: {color: color('ink')}, inactiveColor: color('frame'),
  })).filter(({data}) => data.length > 0));
}

function titleOptions({panels, view}: Layout, color: Colors) {
  const titles = panels.map(({spec, top, far, grid}) => ({
    text: `${spec.title}   {far|${far}}`, left: grid.left, top, padding: 0,
    textStyle: {fontSize: 12, fontWeight: 500, color: color('ink'), rich: {far: {fontSize: 12, color: color('limit')}}},
  }));
  const heading = {text: view.plot.title, left: panels[0].grid.left, top: 4, padding: 0,
                   textStyle: {fontSize: 13, fontWeight: 600, color: color('ink')}};
  return view.heading ? [heading, ...titles] : titles;
}

export function makeOption(layout: Layout, color: Colors) {
  const {view: {plot, extent}, x, panels, notes, noteTop} = layout;
  const last = panels.length - 1;
  const columns = Math.max(2, Math.floor(panels[0].grid.width / 85));
  return {
    animation: false, textStyle: {fontFamily: kFont, fontSize: 12},
    title: titleOptions(layout, color), legend: legendOptions(layout, color),
    grid: panels.map(({grid}) => ({...grid, show: true, borderColor: color('frame'), outerBoundsMode: 'none'})),
    xAxis: panels.map((_, i) => ({
      gridIndex: i, position: 'bottom',
      ...axisOption(plot.x, plot.equal ? x : extent, ticksOf(plot.x, x, columns), color, i === last, 24)})),
    yAxis: panels.map(({spec, y, grid}, i) => ({
      gridIndex: i,
      ...axisOption(spec.y, y, ticksOf(spec.y, y, Math.max(2, Math.floor(grid.height / (plot.equal ? 60 : 34)))), color,
                    true, grid.left - 16)})),
    series: panels.flatMap((panel, i) => [
      marksOption(layout, i, color), ...panel.series.flatMap((series) => seriesOption(layout, i, series, color))]),
    graphic: {elements: notes.map(({label, left, row}, k) => ({
      id: `note-${k}`, type: 'text', silent: true, x: left, y: noteTop + kRow * row + 2,
      style: {text: label, fill: color('quiet'), font: `12px ${kFont}`}}))},
  };
}
