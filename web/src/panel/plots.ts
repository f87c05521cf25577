// Live plots of the last seconds, which one can pause and zoom.
import uPlot from 'uplot';
import {h} from '../dom';
import {kSides, kStages, SceneSpec, stampMs, State} from '../protocol';
import {presentThresholds} from '../scene/stage';
import {hex, kMeaning} from '../theme';
import {distance} from '../scene/frames';

const kWindows = [10, 30, 60];  // [s]
const kKeptSeconds = 66;
const kGapSeconds = 0.5;        // no line is drawn across a longer silence
const kRedrawMs = 120;
const kTickSteps = [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30];  // [s]

type Value = number | null;
interface Series {
  label: string;
  color: string;
  dash?: number[];
  value(state: State, spec: SceneSpec): Value;
}

interface PlotSpec {
  id: string;
  title: string;
  unit: string;
  digits: number;
  least: number;  // of the axis' upper end
  series: Series[];
}

const norm = (v: number[]) => Math.hypot(v[0], v[1], v[2]);
const finite = (v: number): Value => (Number.isFinite(v) ? v : null);
const kShort = {left: 'L', right: 'R'};
const kLimit = {color: hex(kMeaning.red), dash: [6, 4]};

const kPlots: PlotSpec[] = [
  {
    id: 'forces', title: 'Forces', unit: 'N', digits: 1, least: 10,
    series: [
      ...kSides.map((side) => ({
        label: kShort[side], color: hex(kMeaning[side]),
        value: (s: State) => (s.hands[side].present ? finite(norm(s.hands[side].wrench)) : null),
      })),
      {...kLimit, label: 'limit', value: (s, spec) => presentThresholds(spec, s).force},
    ],
  },
  {
    id: 'tracking', title: 'Tracking', unit: 'mm', digits: 2, least: 1,
    series: kSides.map((side) => ({
      label: kShort[side], color: hex(kMeaning[side]),
      value: (s: State) => (s.hands[side].present ?
        finite(1000 * distance(s.hands[side].real.p, s.hands[side].virtual.p)) : null),
    })),
  },
  {
    id: 'elbow', title: 'Elbows', unit: 'm', digits: 2, least: 0.6,
    series: [
      {label: 'apart', color: '#23b5a4', value: (s) => finite(s.elbowDistance)},
      {
        ...kLimit, label: 'limit',
        value: (s, spec) => (Number.isFinite(s.elbowDistance) ? spec.thresholds.security_distance :
                                                                null),
      },
    ],
  },
  {
    id: 'tick', title: 'Tick', unit: 'µs', digits: 1, least: 20,
    series: [
      {label: 'whole', color: '#e0a526', value: (s) => finite(s.stageUs[kStages.indexOf('tick')])},
    ],
  },
];

class Plot {
  readonly element: HTMLElement;
  private readonly plot: uPlot;
  private readonly columns: Value[][];
  private readonly values: HTMLElement[];

  constructor(private readonly spec: PlotSpec, onZoom: (min: number, max: number) => void) {
    this.columns = spec.series.map(() => []);
    this.values = spec.series.map(() => h('span', {class: 'value'}, '–'));
    spec.series.forEach((s, i) => this.values[i].style.setProperty('--series', s.color));
    const holder = h('div', {class: 'canvas'});
    this.element = h(
        'figure', {class: 'plot', id: `plot-${spec.id}`},
        h('figcaption', {}, h('b', {}, `${spec.title} [${spec.unit}]`),
          h('span', {class: 'legend'}, ...spec.series.map((s, i) => {
            const item = h('span', {class: s.dash ? 'key dashed' : 'key'}, s.label, ' ',
                           this.values[i]);
            item.style.setProperty('--series', s.color);
            return item;
          }))),
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
    this.plot.setData([times, ...this.columns] as uPlot.AlignedData, false);
    this.plot.setScale('x', {min, max});
    this.columns.forEach((column, i) => {
      const value = column.at(-1);
      this.values[i].textContent = value == null ? '–' : value.toFixed(this.spec.digits);
    });
  }

  // Axes are painted on a canvas, which no style sheet reaches.
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
      cursor: {drag: {x: true, y: false, setScale: false}, points: {show: false}},
      scales: {
        x: {time: false},
        y: {range: (_u, _min, max) => [0, Math.max((max ?? 0) * 1.12, this.spec.least)]},
      },
      axes: [
        {...axis, size: 20, gap: 2, splits: (u, _i, min, max) => this.ticks(u, min, max),
         values: (u, ticks) => ticks.map((t) => this.agoText(u, t))},
        {...axis, size: 38, gap: 3, space: 26},
      ],
      series: [
        {},
        ...this.spec.series.map((s) => ({
          label: s.label, stroke: s.color, width: 1.6, dash: s.dash, points: {show: false},
        })),
      ],
      hooks: {
        setSelect: [(u) => {
          if (u.select.width < 4) return;
          onZoom(u.posToVal(u.select.left, 'x'), u.posToVal(u.select.left + u.select.width, 'x'));
          u.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
        }],
      },
    };
  }

  // Round times before the newest.
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

export class Plots {
  readonly element: HTMLElement;
  paused = false;
  window = 10;  // [s]
  private zoomed: [number, number] | null = null;
  private times: number[] = [];
  private readonly plots: Plot[];
  private readonly pauseButton: HTMLButtonElement;
  private readonly windowButtons: HTMLButtonElement[];
  private readonly waiting: [State, SceneSpec, number][] = [];  // while paused
  private lastDrawMs = 0;

  constructor() {
    this.plots = kPlots.map((spec) => new Plot(spec, (min, max) => this.zoom(min, max)));
    this.pauseButton = h('button', {
      class: 'small', id: 'plots-pause', 'aria-pressed': 'false',
      onclick: () => this.setPaused(!this.paused),
    }, 'Pause');
    this.windowButtons = kWindows.map((seconds) => h('button', {
      class: 'small', id: `window-${seconds}`, 'aria-pressed': String(seconds === this.window),
      'aria-label': `Show ${seconds} seconds`, onclick: () => this.setWindow(seconds),
    }, `${seconds} s`));
    this.element = h(
        'section', {class: 'dock', 'aria-label': 'Live plots'},
        h('div', {class: 'dock-tools', role: 'toolbar', 'aria-label': 'Plots'}, this.pauseButton,
          ...this.windowButtons, h('span', {class: 'hint'}, 'drag to zoom')),
        h('div', {class: 'plots'}, ...this.plots.map((plot) => plot.element)));
  }

  add(state: State, spec: SceneSpec) {
    const time = stampMs(state) / 1000;
    if (this.paused) {
      this.waiting.push([state, spec, time]);
      if (this.waiting.length > 60 * kKeptSeconds) this.waiting.shift();
      return;
    }
    this.append(state, spec, time);
  }

  // After a new connection or a restart: times may have begun anew.
  clear() {
    this.waiting.length = 0;
    for (const plot of this.plots) plot.trim(this.times.length);
    this.times = [];
    this.setPaused(false);
  }

  setPaused(paused: boolean) {
    this.paused = paused;
    this.pauseButton.setAttribute('aria-pressed', String(paused));
    this.pauseButton.textContent = paused ? 'Resume' : 'Pause';
    if (paused) return;
    this.zoomed = null;
    for (const [state, spec, time] of this.waiting.splice(0)) this.append(state, spec, time);
  }

  setWindow(seconds: number) {
    this.window = seconds;
    this.zoomed = null;
    kWindows.forEach((s, i) =>
      this.windowButtons[i].setAttribute('aria-pressed', String(s === seconds)));
    this.lastDrawMs = 0;
  }

  draw(nowMs: number) {
    if (nowMs - this.lastDrawMs < kRedrawMs || this.times.length === 0) return;
    this.lastDrawMs = nowMs;
    const [min, max] = this.range();
    for (const plot of this.plots) plot.draw(this.times, min, max);
  }

  repaint() {
    for (const plot of this.plots) plot.repaint();
  }

  // Shown times [s], relative to the newest.
  shownRange(): [number, number] {
    const [min, max] = this.range();
    const last = this.times.at(-1) ?? 0;
    return [min - last, max - last];
  }

  get points(): number {
    return this.times.length;
  }

  private range(): [number, number] {
    const last = this.times.at(-1) ?? 0;
    return this.zoomed ?? [last - this.window, last];
  }

  private zoom(min: number, max: number) {
    this.setPaused(true);
    this.zoomed = [min, max];
    this.lastDrawMs = 0;
  }

  private append(state: State, spec: SceneSpec, time: number) {
    const last = this.times.at(-1);
    if (last !== undefined && time <= last) return;
    if (last !== undefined && time - last > kGapSeconds) {
      this.times.push(last + 1e-3);
      for (const plot of this.plots) plot.add(null, spec);
    }
    this.times.push(time);
    for (const plot of this.plots) plot.add(state, spec);
    const old = this.times.findIndex((t) => t > time - kKeptSeconds);
    if (old > 600) {
      this.times.splice(0, old);
      for (const plot of this.plots) plot.trim(old);
    }
  }
}
