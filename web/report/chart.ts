// Shows an interactive plot with zoom and cursor. The library draws it. This file also selects the
// points of long lines that are drawn.
import type {ECharts} from 'echarts/core';
import {h} from '../src/dom';
import {readable} from './axis';
import {PlotSpec, Range, readSeries, Series} from './data';
import {draw, make} from './drawing';
import {Colors, Layout, layOut, makeOption, seriesName, wholeX} from './option';

const kReach = 8;         // maximum distance of the cursor from a marker [px]
const kFileWidth = 900;   // of a saved picture [px]
const kPaperWidth = 900;  // of a printed plot, which is scaled to the paper's width [px]

// Returns the colours of the page's present style: dark, light or print.
const pageColors: Colors = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

// Returns the colours of the light page, regardless of the present style. Saved pictures use them.
function lightColors(): Colors {
  const {dataset} = document.documentElement;
  const before = dataset.theme;
  dataset.theme = 'light';
  const style = getComputedStyle(document.documentElement);
  const colors = new Map(['ink', 'quiet', 'grid', 'shade', 'frame', 'limit', 'surface', ...'01234567'].map((name) => {
    const key = /\d/.test(name) ? `c${name}` : name;
    return [key, style.getPropertyValue(`--${key}`).trim()];
  }));
  if (before === undefined) delete dataset.theme;
  else dataset.theme = before;
  return (name) => colors.get(name)!;
}

export class Chart {
  readonly element: HTMLElement;
  visible = false;
  private readonly canvas = h('div', {class: 'canvas'});
  private readonly reset: HTMLButtonElement;
  private readonly series: Series[][];
  private readonly whole: Range;
  private readonly hidden = new Set<string>();
  private view: Range | null = null;  // range of x; null: complete
  private layout: Layout | null = null;
  private chart: ECharts | null = null;
  private waiting = false;

  // `zoomed` is called when this plot's view changes. `pointed` is called with the cursor's
  // position, for the other plots of the group.
  constructor(readonly spec: PlotSpec, private readonly zoomed: (view: Range | null) => void,
              private readonly pointed: (x: number | null) => void) {
    this.series = spec.panels.map((panel) => panel.series.map(readSeries));
    this.whole = wholeX(spec, this.series);
    this.reset = h('button', {type: 'button', class: 'reset', disabled: true, onclick: () => this.choose(null)},
                   'Whole view');
    const save = h('button', {type: 'button', class: 'save', onclick: () => this.save()}, 'Save as SVG');
    this.element = h(
        'div', {class: 'live', tabindex: '0', role: 'group',
                'aria-label': 'Plot: drag to zoom, double-click for the whole view'},
        this.canvas, h('div', {class: 'tools'}, this.reset, save));
    this.element.addEventListener('keydown', (event) => this.onKey(event));
    this.element.addEventListener('dblclick', () => this.choose(null));
    new ResizeObserver(() => this.redraw()).observe(this.element);
  }

  setView(view: Range | null) {
    this.view = view;
    this.redraw();
  }

  // Shows the cursor of another plot of the group. The value null means that the cursor has left
  // that plot.
  setCursor(x: number | null) {
    if (!this.visible || !this.chart || !this.layout) return;
    const px = x === null ? NaN : Number(this.chart.convertToPixel({xAxisIndex: 0}, x));
    const {left, width, top} = this.layout.panels[0].grid;
    if (px >= left && px <= left + width) this.chart.dispatchAction({type: 'showTip', x: px, y: top + 1});
    else this.chart.dispatchAction({type: 'updateAxisPointer', currTrigger: 'leave'});
  }

  redraw() {
    if (this.waiting || !this.visible) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  private layOutFor(width: number, heading = false): Layout {
    const x = this.view ?? this.whole;
    const extent = heading ? x : this.whole;
    return layOut({plot: this.spec, series: this.series, x, extent, hidden: this.hidden, width, heading});
  }

  // Draws immediately. On paper, the plot is scaled to the width of the page.
  draw() {
    const paper = matchMedia('print').matches;
    const width = paper ? kPaperWidth : this.element.clientWidth;
    if (width < 120) return;
    this.layout = this.layOutFor(width);
    const {height} = this.layout;
    this.canvas.style.height = `${height}px`;
    const made = this.chart === null;
    this.chart ??= this.begin(width, height);
    this.chart.resize({width, height, silent: true});
    this.chart.setOption({...makeOption(this.layout, pageColors), ...this.interaction()},
                         {replaceMerge: ['series', 'graphic', 'legend', 'title'], silent: true});
    if (made && !this.spec.equal) {
      this.chart.dispatchAction({type: 'takeGlobalCursor', key: 'dataZoomSelect', dataZoomSelectActive: true});
    }
    this.chart.getZr().flush();
    const svg = this.canvas.querySelector('svg')!;
    if (paper) svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
    else svg.removeAttribute('viewBox');
    this.reset.disabled = this.view === null;
  }

  // Handles zoom and cursor. A drag selects a range of x, or moves the picture if both axes have
  // equal scales.
  private interaction() {
    const {spec: {equal}, layout} = this;
    const zoom = {
      type: 'inside', filterMode: 'none', zoomOnMouseWheel: 'ctrl', moveOnMouseWheel: false,
      moveOnMouseMove: equal ? true : 'shift', throttle: 0,
    };
    const label = {show: true, formatter: ({value}: {value: unknown}) => readable(Number(value))};
    if (equal) {
      return {
        dataZoom: [{...zoom, xAxisIndex: 0}, {...zoom, yAxisIndex: 0}],
        axisPointer: {show: true, triggerTooltip: false, label, lineStyle: {color: pageColors('quiet')}},
      };
    }
    const {low, high} = layout!.x;
    return {
      dataZoom: [{...zoom, xAxisIndex: 'all', startValue: low, endValue: high}],
      axisPointer: {
        link: [{xAxisIndex: 'all'}], snap: false, lineStyle: {color: pageColors('quiet'), type: 'solid'}},
      toolbox: {itemSize: 0, showTitle: false, right: 0, top: 0, feature: {dataZoom: {
        yAxisIndex: 'none', filterMode: 'none',
        brushStyle: {color: pageColors('accent'), opacity: 0.2, borderWidth: 0}}}},
      tooltip: {
        trigger: 'axis', confine: true, transitionDuration: 0, axisPointer: {type: 'line', animation: false},
        backgroundColor: pageColors('surface'), borderColor: pageColors('line'), className: 'tip',
        textStyle: {color: pageColors('ink'), fontSize: 13},
        formatter: (at: {axisValue: number}[]) => this.tip(Number(at[0].axisValue)),
      },
    };
  }

  // Lists the values of all visible lines at x.
  private tip(x: number): HTMLElement {
    const {spec, layout} = this;
    const reach = kReach * (layout!.x.high - layout!.x.low) / layout!.panels[0].grid.width;
    return h('div', {}, h('b', {}, `${spec.x.title}: ${readable(x)}`), ...spec.panels.flatMap((panel, i) =>
      this.series[i].filter(({spec: {kind}}) => kind !== 'area').map((series) => {
        const value = series.at(x, reach);
        const absent = Number.isNaN(value) && series.spec.kind !== 'line';
        if (absent || this.hidden.has(seriesName(i, series))) return null;
        const key = h('i', {class: series.spec.style});
        key.style.setProperty('--series', `var(--c${series.spec.color})`);
        const name = [panel.title, series.spec.label].filter((words) => words !== '').join(', ');
        return h('div', {class: 'row'}, key, h('span', {}, name || panel.y.title),
                 h('span', {class: 'value'}, `${readable(value)} ${panel.y.unit}`));
      })));
  }

  private onZoom() {
    const {spec, layout, chart, whole} = this;
    if (!layout || !chart) return;
    if (spec.equal) {
      this.reset.disabled = false;
      return;
    }
    const {left, width} = layout.panels[0].grid;
    const [low, high] = [left, left + width].map((px) => Number(chart.convertFromPixel({xAxisIndex: 0}, px)));
    const near = 1e-6 * (whole.high - whole.low);
    this.choose(low <= whole.low + near && high >= whole.high - near ? null : {low, high});
  }

  private choose(view: Range | null) {
    this.view = view;
    if (this.spec.equal) this.chart?.dispatchAction({type: 'dataZoom', batch: [0, 1].map(
        (dataZoomIndex) => ({dataZoomIndex, start: 0, end: 100}))}, {silent: true});
    this.redraw();
    this.zoomed(view);
  }

  private onKey(event: KeyboardEvent) {
    const {low, high} = this.whole;
    const {low: a, high: b} = this.view ?? this.whole;
    const show = (from: number, to: number) => this.choose(
        from <= low && to >= high ? null : {low: Math.max(from, low), high: Math.min(to, high)});
    const move = (by: number) => {
      const step = Math.max(Math.min(by * (b - a), high - b), low - a);
      show(a + step, b + step);
    };
    const free = !this.spec.equal && !this.spec.x.log;
    if (event.key === '0' || event.key === 'Escape') this.choose(null);
    else if (!free) return;
    else if (event.key === '+') show(a + (b - a) / 4, b - (b - a) / 4);
    else if (event.key === '-') show(a - (b - a) / 2, b + (b - a) / 2);
    else if (event.key === 'ArrowLeft' && this.view) move(-0.2);
    else if (event.key === 'ArrowRight' && this.view) move(0.2);
    else return;
    event.preventDefault();
  }

  // Saves the plot as a file with its present zoom, on a white background.
  private save() {
    const svg = draw(this.layOutFor(kFileWidth, true), lightColors());
    const url = URL.createObjectURL(new Blob([svg], {type: 'image/svg+xml'}));
    h('a', {href: url, download: `${this.spec.id}.svg`}).click();
    setTimeout(() => URL.revokeObjectURL(url), 60_000);
  }

  private begin(width: number, height: number): ECharts {
    const chart = make(this.canvas, width, height);
    chart.on('datazoom', () => this.onZoom());
    chart.on('legendselectchanged', (event) => {
      const {name, selected} = event as {name: string; selected: Record<string, boolean>};
      if (selected[name]) this.hidden.delete(name);
      else this.hidden.add(name);
      this.redraw();
    });
    const zr = chart.getZr();
    zr.on('mousemove', ({offsetX, offsetY}) => {
      const inside = chart.containPixel('grid', [offsetX, offsetY]);
      if (!this.spec.equal) this.pointed(inside ? Number(chart.convertFromPixel({xAxisIndex: 0}, offsetX)) : null);
    });
    zr.on('globalout', () => this.pointed(null));
    return chart;
  }
}
