// Shows one live plot. This file also contains the list of plotted quantities.
import uPlot from 'uplot';
import {h} from '../dom';
import {HandState, kSides, kStages, SceneSpec, Side, State} from '../protocol';
import {angle, distance} from '../scene/frames';
import {presentThresholds} from '../scene/stage';
import {hex, kMeaning} from '../theme';
import {fixed} from '../words';

const kTickSteps = [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30];  // [s]

type Value = number | null;
interface Series {
  label: string;
  name: string;    // name in a saved table
  color: string;
  limit?: number;  // for a limit's line: the axis includes it once a value reaches this share of it
  value(state: State, spec: SceneSpec): Value;
}

export interface PlotSpec {
  id: string;
  title: string;
  unit: string;
  digits: number;
  least: number;  // smallest upper end of the axis
  series: Series[];
}

const kDashes = [6, 4];
const norm = (v: number[]) => Math.hypot(v[0], v[1], v[2]);
const finite = (v: number): Value => (Number.isFinite(v) ? v : null);
const kShort = {left: 'L', right: 'R'};

function bySide(name: string, value: (hand: HandState) => number): Series[] {
  return kSides.map((side: Side) => ({
    label: kShort[side], name: `${side}_${name}`, color: hex(kMeaning[side]),
    value: (s: State) => (s.hands[side].present ? finite(value(s.hands[side])) : null),
  }));
}

function limit(name: string, from: number, value: Series['value']): Series {
  return {label: 'limit', name: `${name}_limit`, color: hex(kMeaning.red), limit: from, value};
}

// The plots form groups. In each group, one plot is visible at a time.
export const kPlots: PlotSpec[][] = [
  [
    {
      id: 'forces', title: 'Force', unit: 'N', digits: 1, least: 10,
      series: [
        ...bySide('force', ({wrench}) => norm(wrench)),
        limit('force', 0, (s, spec) => presentThresholds(spec, s).force),
      ],
    },
    {
      id: 'torques', title: 'Torque', unit: 'N·m', digits: 2, least: 1,
      series: [
        ...bySide('torque', ({wrench}) => norm(wrench.slice(3))),
        limit('torque', 0, (s, spec) => presentThresholds(spec, s).torque),
      ],
    },
  ],
  [
    {
      id: 'tracking', title: 'Tracking', unit: 'mm', digits: 2, least: 1,
      series: [
        ...bySide('tracking', ({real, virtual}) => 1000 * distance(real.p, virtual.p)),
        limit('tracking', 0.3, (_s, spec) => 1000 * spec.thresholds.tracking),
      ],
    },
    {
      id: 'rotation', title: 'Rotation', unit: '°', digits: 2, least: 0.5,
      series: bySide('rotation', ({real, virtual}) => (180 / Math.PI) * angle(real.q, virtual.q)),
    },
  ],
  [{
    id: 'links', title: 'Nearest links', unit: 'm', digits: 2, least: 0.6,
    series: [
      {label: 'apart', name: 'link_distance', color: '#23b5a4', value: (s) => finite(s.linkDistance)},
      limit('link_distance', 0, (s, spec) => (Number.isFinite(s.linkDistance) ?
        spec.thresholds.security_distance : null)),
    ],
  }],
  [{
    id: 'tick', title: 'Tick', unit: 'µs', digits: 1, least: 20,
    series: [{label: 'whole', name: 'tick', color: '#e0a526',
              value: (s) => finite(s.stageUs[kStages.indexOf('tick')])}],
  }],
];

const kSync = uPlot.sync('predictor');  // all plots share one cursor

export class Plot {
  readonly element: HTMLElement;
  readonly columns: Value[][];
  private readonly plot: uPlot;
  private readonly values: HTMLElement[];
  private shown: [number, number] = [0, 0];  // times [s]

  // `title` is the element that shows the title in front of the values.
  constructor(readonly spec: PlotSpec, title: HTMLElement,
              onZoom: (min: number, max: number) => void,
              private readonly onCursor: (time: number | null) => void) {
    this.columns = spec.series.map(() => []);
    this.values = spec.series.map(() => h('span', {class: 'value'}, '–'));
    spec.series.forEach((s, i) => this.values[i].style.setProperty('--series', s.color));
    const holder = h('div', {class: 'canvas'});
    this.element = h(
        'figure', {class: 'plot', id: `plot-${spec.id}`},
        h('figcaption', {},
          title,
          h('span', {class: 'legend'}, ...spec.series.map((s, i) => {
            const item = h('span', {class: s.limit === undefined ? 'key' : 'key dashed', title: s.label},
                           h('span', {class: 'name'}, s.label), ' ', this.values[i]);
            item.style.setProperty('--series', s.color);
            return item;
          }), spec.unit)),
        holder);
    this.plot = new uPlot(this.options(onZoom), [[], ...spec.series.map(() => [])], holder);
    new ResizeObserver(() => this.resize(holder)).observe(holder);
  }

  add(state: State | null, scene: SceneSpec) {
    this.spec.series.forEach((s, i) => this.columns[i].push(state ? s.value(state, scene) : null));
  }

  trim(count: number) {
    for (const column of this.columns) column.splice(0, count);
  }

  draw(times: number[], min: number, max: number) {
    this.shown = [min, max];
    this.plot.setData([times, ...this.columns] as uPlot.AlignedData, false);
    this.plot.setScale('x', {min, max});
    this.showValues();
  }

  // Shows the values at the cursor. If there is no cursor, shows the newest values.
  private showValues() {
    const at = this.plot.cursor.idx;
    this.columns.forEach((column, i) => {
      const value = at == null ? column.at(-1) : column[at];
      this.values[i].textContent = value == null ? '–' : fixed(value, this.spec.digits);
    });
  }

  // The plot's canvas, to be copied into a picture.
  get canvas(): HTMLCanvasElement {
    return this.plot.ctx.canvas;
  }

  // Axes are painted on a canvas, to which style sheets do not apply.
  repaint() {
    this.plot.redraw(false, true);
  }

  private options(onZoom: (min: number, max: number) => void): uPlot.Options {
    const style = (name: string) =>
      getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const axis: uPlot.Axis = {
      stroke: () => style('--quiet'),
      grid: {stroke: () => style('--line'), width: 1},
      ticks: {show: false},
      font: '11px system-ui, sans-serif',
    };
    return {
      width: 240,
      height: 120,
      legend: {show: false},
      cursor: {
        drag: {x: true, y: false, setScale: false}, points: {show: false}, y: false,
        // All plots show the same time. If the person zooms in a plot, this plot reports the new
        // range.
        sync: {
          key: kSync.key, setSeries: false, scales: ['x', null],
          filters: {pub: (type) => type === 'mousemove' || type === 'mouseleave'},
        },
      },
      scales: {x: {time: false}, y: {range: (u) => [0, this.upperEnd(u)]}},
      axes: [
        // The gap keeps the first time clear of the zero of the other axis.
        {...axis, size: 23, gap: 6, splits: (u, _i, min, max) => this.ticks(u, min, max),
         values: (u, ticks) => ticks.map((t) => this.agoText(u, t))},
        {...axis, size: 38, gap: 3, space: 26},
      ],
      series: [
        {},
        ...this.spec.series.map((s) => ({
          label: s.label, stroke: s.color, width: 1.6, points: {show: false},
          dash: s.limit === undefined ? undefined : kDashes,
        })),
      ],
      hooks: {
        setSelect: [(u) => {
          if (u.select.width < 4) return;
          onZoom(u.posToVal(u.select.left, 'x'), u.posToVal(u.select.left + u.select.width, 'x'));
          u.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
        }],
        setCursor: [(u) => {
          this.showValues();
          this.onCursor(u.cursor.idx == null ? null : u.data[0][u.cursor.idx]);
        }],
      },
    };
  }

  // Returns the upper end of the visible values. The visible range includes a limit once the values
  // approach this limit.
  private upperEnd(u: uPlot): number {
    const times = u.data[0];
    const [min, max] = this.shown;
    const largest = (column: Value[]) => column.reduce<number>(
        (most, v, i) => (v !== null && v > most && times[i] >= min && times[i] <= max ? v : most), 0);
    const isLimit = (i: number) => this.spec.series[i].limit !== undefined;
    let end = Math.max(0, ...this.columns.filter((_c, i) => !isLimit(i)).map(largest));
    this.columns.forEach((column, i) => {
      const line = isLimit(i) ? largest(column) : 0;
      if (line > 0 && end >= this.spec.series[i].limit! * line) end = Math.max(end, line);
    });
    return Math.max(end * 1.12, this.spec.least);
  }

  // Returns round numbers for the times before the newest time.
  private ticks(u: uPlot, min: number, max: number): number[] {
    const last = u.data[0].at(-1) ?? max;
    const step = kTickSteps.find((s) => (max - min) / s <= 5) ?? kTickSteps.at(-1)!;
    const first = Math.ceil((min - last) / step);
    const count = Math.floor((max - last) / step) - first + 1;
    return Array.from({length: Math.max(count, 0)}, (_, i) => last + (first + i) * step);
  }

  private agoText(u: uPlot, t: number): string {
    const ago = t - (u.data[0].at(-1) ?? t);
    if (Math.abs(ago) < 1e-3) return 'now';
    return `${ago.toFixed(Math.abs(ago % 1) > 0.05 ? 1 : 0)} s`;
  }

  private resize(holder: HTMLElement) {
    const {clientWidth, clientHeight} = holder;
    if (clientWidth > 40 && clientHeight > 30) {
      this.plot.setSize({width: clientWidth, height: clientHeight});
    }
  }
}
