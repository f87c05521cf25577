// A plot that one can zoom into and read: panels one above another, a canvas each.
import {h, setText} from '../src/dom';
import {linearTicks, logTicks, Range, readable, Ticks, yRange} from './axis';
import {lowerBound, merge, PanelSpec, PlotSpec, Points, SeriesSpec, thin, xColumn, yColumn} from './spec';

// [px]
const kLeft = 62;
const kRight = 14;
const kTop = 6;
const kBottom = 40;
const kHeight = 170;
const kRow = 16;
const kFont = '12px system-ui, "Segoe UI", Helvetica, Arial, sans-serif';
const kMostPoints = 5000;  // of a line in view: of more the extremes of each few are drawn
const kDashes = {solid: [], dashed: [6, 3], dotted: [2, 2.5]};
const kLeastDrag = 6;

// Colours of the page's style, kept: asking for one makes the browser look through the whole page.
const colors = new Map<string, string>();

function style(name: string): string {
  let value = colors.get(name);
  if (value === undefined) {
    value = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    colors.set(name, value);
  }
  return value;
}

// Dark or light has changed.
export function forgetColors() {
  colors.clear();
}

// With a rim, so that lines do not run through the words.
function words(g: CanvasRenderingContext2D, text: string, x: number, y: number) {
  g.save();
  g.strokeStyle = style('--surface');
  g.lineWidth = 3.5;
  g.lineJoin = 'round';
  g.setLineDash([]);
  g.strokeText(text, x, y);
  g.restore();
  g.fillText(text, x, y);
}

// Where the words of the line at `py` stand: above or below it, within the box, where no other line
// runs through them and no others stand; where there is no such place, above.
function heightOfWords(py: number, lines: number[], others: number[], box: Box): number {
  const free = (at: number) => at - 10 >= box.top && at + 3 <= box.bottom &&
      lines.every((line) => line === py || line < at - 10 || line > at + 3) &&
      others.every((other) => Math.abs(other - at) >= kRow - 3);
  return [py - 4, py + 13].find(free) ?? (py - box.top > kRow ? py - 4 : py + 13);
}

class Series {
  visible = true;
  readonly points: Points;
  private readonly levels: Points[];  // each an eighth of the one before
  readonly error: Float32Array | null;

  constructor(readonly spec: SeriesSpec) {
    const coarse = {x: xColumn(spec.x), y: yColumn(spec.y)};
    this.error = spec.error === undefined ? null : yColumn(spec.error);
    this.points = spec.xDetail === undefined || spec.yDetail === undefined ?
        coarse : merge(coarse, {x: xColumn(spec.xDetail), y: yColumn(spec.yDetail)});
    this.levels = [this.points];
    if (spec.kind !== 'line') return;
    while (this.levels.at(-1)!.x.length > kMostPoints) this.levels.push(thin(this.levels.at(-1)!));
  }

  // What is drawn between two values of x: places in an array of points.
  view({low, high}: Range): [Points, number, number] {
    let view: [Points, number, number] = [this.points, 0, this.points.x.length];
    if (this.spec.kind === 'path') return view;
    for (const points of this.levels) {
      view = [points, Math.max(lowerBound(points.x, low) - 1, 0),
              Math.min(lowerBound(points.x, high) + 1, points.x.length)];
      if (view[2] - view[1] <= kMostPoints) break;
    }
    return view;
  }

  // The value at x, that of the sample before; NaN in a gap.
  at(x: number): number {
    const {points} = this;
    const i = lowerBound(points.x, x);
    if (this.spec.kind !== 'line') {
      if (i === 0) return points.y[0];
      if (i === points.x.length) return points.y[i - 1];
      return x - points.x[i - 1] < points.x[i] - x ? points.y[i - 1] : points.y[i];
    }
    return i < points.x.length && points.x[i] === x ? points.y[i] : i > 0 ? points.y[i - 1] : NaN;
  }
}

interface Box {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

class Panel {
  readonly element: HTMLElement;
  readonly canvas = h('canvas', {});
  readonly series: Series[];
  readonly cursor = h('div', {class: 'cursor', hidden: true});
  readonly selection = h('div', {class: 'selection', hidden: true});
  private readonly values: HTMLElement[];
  private readonly far: HTMLElement;
  box: Box = {left: kLeft, top: kTop, right: kLeft + 1, bottom: kTop + 1};
  x: Range = {low: 0, high: 1};
  y: Range = {low: 0, high: 1};

  constructor(readonly plot: PlotSpec, readonly spec: PanelSpec, readonly first: boolean,
              readonly last: boolean, changed: () => void) {
    this.series = spec.series.map((s) => new Series(s));
    this.values = spec.series.map(() => h('span', {class: 'value'}));
    this.far = h('span', {class: 'far'});
    const keys = spec.series.map((s, i) => {
      const key = h('button', {
        type: 'button', class: `key ${s.style} ${s.kind}`, 'aria-pressed': 'true',
        title: 'Show or hide',
        onclick: () => {
          this.series[i].visible = !this.series[i].visible;
          key.setAttribute('aria-pressed', String(this.series[i].visible));
          changed();
        },
      }, h('i'), s.label || spec.y.title.replace(/ \[.*/, ''), ' ', this.values[i]);
      key.style.setProperty('--series', `var(--c${s.color})`);
      return key;
    });
    this.element = h(
        'div', {class: 'panel'},
        h('div', {class: 'head'}, h('b', {}, spec.title), h('span', {class: 'keys'}, ...keys, this.far)),
        h('div', {class: 'canvas'}, this.canvas, this.cursor, this.selection));
  }

  get axisBottom() {
    return this.last ? kBottom : 6;
  }

  toX(x: number) {
    const {low, high} = this.x;
    const share = this.plot.x.log ? Math.log(x / low) / Math.log(high / low) : (x - low) / (high - low);
    return this.box.left + share * (this.box.right - this.box.left);
  }

  fromX(px: number) {
    const {low, high} = this.x;
    const share = (px - this.box.left) / (this.box.right - this.box.left);
    return this.plot.x.log ? low * (high / low) ** share : low + share * (high - low);
  }

  toY(y: number) {
    const {low, high} = this.y;
    const share = this.spec.y.log ? Math.log(y / low) / Math.log(high / low) : (y - low) / (high - low);
    return this.box.bottom - share * (this.box.bottom - this.box.top);
  }

  fromY(py: number) {
    const {low, high} = this.y;
    return low + (this.box.bottom - py) / (this.box.bottom - this.box.top) * (high - low);
  }

  // Of the lines that are shown, within the view.
  dataRange(): Range {
    let low = Infinity;
    let high = -Infinity;
    for (const series of this.series) {
      if (!series.visible) continue;
      const [points, from, to] = series.view(this.x);
      for (let i = from; i < to; ++i) {
        if (points.x[i] < this.x.low || points.x[i] > this.x.high) continue;
        const y = points.y[i];
        if (this.spec.y.log && y <= 0) continue;
        const error = series.error ? series.error[i] : 0;
        if (y - error < low) low = y - error;
        if (y + error > high) high = y + error;
      }
    }
    return {low, high};
  }

  showValues(x: number | null, nearest: string[] | null = null) {
    this.series.forEach((series, i) => {
      setText(this.values[i], nearest ? nearest[i] : x === null ? '' : readable(series.at(x)));
    });
    this.cursor.hidden = x === null || x < this.x.low || x > this.x.high;
    if (x === null || this.cursor.hidden) return;
    this.cursor.style.left = `${this.toX(x)}px`;
    this.cursor.style.top = `${this.box.top}px`;
    this.cursor.style.height = `${this.box.bottom - this.box.top}px`;
  }

  resize(width: number, height: number, notes: number): CanvasRenderingContext2D {
    const total = notes + kTop + height + this.axisBottom;
    const scale = devicePixelRatio || 1;
    this.canvas.width = Math.round(width * scale);
    this.canvas.height = Math.round(total * scale);
    this.canvas.style.width = `${width}px`;
    this.canvas.style.height = `${total}px`;
    this.box = {left: kLeft, top: notes + kTop, right: width - kRight, bottom: notes + kTop + height};
    const g = this.canvas.getContext('2d')!;
    g.setTransform(scale, 0, 0, scale, 0, 0);
    g.font = kFont;
    return g;
  }

  // `lines`: what else lies under the words.
  draw(g: CanvasRenderingContext2D, lines: () => void) {
    const {box} = this;
    this.drawSpans(g);
    lines();
    this.drawGrid(g);
    g.save();
    g.beginPath();
    g.rect(box.left, box.top, box.right - box.left, box.bottom - box.top);
    g.clip();
    for (const series of this.series) if (series.visible) this.drawSeries(g, series);
    g.restore();
    this.drawLimits(g);
    this.drawMarks(g);
    g.strokeStyle = style('--frame');
    g.strokeRect(box.left, box.top, box.right - box.left, box.bottom - box.top);
  }

  private drawSpans(g: CanvasRenderingContext2D) {
    const {box} = this;
    for (const span of this.plot.spans) {
      const from = Math.max(this.toX(span.from), box.left);
      const to = Math.min(this.toX(span.to), box.right);
      if (!(from < to)) continue;
      g.fillStyle = style('--shade');
      g.fillRect(from, box.top, to - from, box.bottom - box.top);
      if (!this.first || to - from < g.measureText(span.label).width + 6) continue;
      g.fillStyle = style('--quiet');
      g.textAlign = 'center';
      words(g, span.label, (from + to) / 2, box.top + 13);
    }
  }

  private xTicks(): Ticks {
    const {categories} = this.plot.x;
    if (categories.length > 0) return {at: categories.map((_, i) => i), text: categories};
    const count = Math.max(2, Math.floor((this.box.right - this.box.left) / 85));
    return this.plot.x.log ? logTicks(this.x, count) : linearTicks(this.x, count);
  }

  private drawGrid(g: CanvasRenderingContext2D) {
    const {box} = this;
    const line = (x1: number, y1: number, x2: number, y2: number) => {
      g.beginPath();
      g.moveTo(x1, y1);
      g.lineTo(x2, y2);
      g.stroke();
    };
    const ticks = this.xTicks();
    g.strokeStyle = style('--grid');
    ticks.at.forEach((at, i) => {
      const px = this.toX(at);
      if (px < box.left - 0.5 || px > box.right + 0.5) return;
      if (this.plot.x.categories.length === 0) line(px, box.top, px, box.bottom);
      if (!this.last) return;
      g.fillStyle = style('--quiet');
      g.textAlign = 'center';
      g.fillText(ticks.text[i], px, box.bottom + kRow);
    });
    g.fillStyle = style('--ink');
    if (this.last) g.fillText(this.plot.x.title, (box.left + box.right) / 2, box.bottom + 2 * kRow + 2);
    const rows = Math.max(2, Math.floor((box.bottom - box.top) / (this.plot.equal ? 60 : 34)));
    const heights = this.spec.y.log ? logTicks(this.y, rows) : linearTicks(this.y, rows);
    heights.at.forEach((at, i) => {
      const py = this.toY(at);
      line(box.left, py, box.right, py);
      g.fillStyle = style('--quiet');
      g.textAlign = 'right';
      g.fillText(heights.text[i], box.left - 6, py + 4);
    });
    g.save();
    g.translate(13, (box.top + box.bottom) / 2);
    g.rotate(-Math.PI / 2);
    g.textAlign = 'center';
    g.fillStyle = style('--ink');
    g.fillText(this.spec.y.title, 0, 0);
    g.restore();
  }

  private drawSeries(g: CanvasRenderingContext2D, series: Series) {
    const {spec} = series;
    const [points, from, to] = series.view(this.x);
    g.strokeStyle = g.fillStyle = style(`--c${spec.color}`);
    g.lineWidth = 1.4;
    g.lineJoin = 'round';
    g.setLineDash(kDashes[spec.style]);
    if (spec.kind === 'bars' || spec.kind === 'markers') {
      g.setLineDash([]);
      for (let i = from; i < to; ++i) this.drawPoint(g, series, points, i);
    } else {
      g.beginPath();
      if (spec.kind === 'path') this.tracePath(g, points);
      else this.traceLine(g, points, from, to);
      g.stroke();
    }
    g.setLineDash([]);
    g.lineWidth = 1;
  }

  // The first, lowest, highest and last point of each pixel: all that can be seen of the line.
  private traceLine(g: CanvasRenderingContext2D, points: Points, from: number, to: number) {
    const dense = to - from > 3 * (this.box.right - this.box.left);
    const log = this.spec.y.log;
    let pen = false;
    let column = NaN;
    let low = 0;
    let high = 0;
    let last = 0;
    const flush = () => {
      if (Number.isNaN(column)) return;
      if (high !== low) {
        g.lineTo(column, low);
        g.lineTo(column, high);
      }
      g.lineTo(column, last);
      column = NaN;
    };
    for (let i = from; i < to; ++i) {
      const y = points.y[i];
      if (Number.isNaN(y) || (log && y <= 0)) {
        flush();
        pen = false;
        continue;
      }
      const px = dense ? Math.round(this.toX(points.x[i])) : this.toX(points.x[i]);
      const py = this.toY(y);
      if (px !== column) {
        flush();
        if (pen) g.lineTo(px, py);
        else g.moveTo(px, py);
        pen = true;
        column = px;
        low = high = last = py;
      } else {
        if (py < low) low = py;
        if (py > high) high = py;
        last = py;
      }
    }
    flush();
  }

  private tracePath(g: CanvasRenderingContext2D, points: Points) {
    let pen = false;
    let lastX = 0;
    let lastY = 0;
    for (let i = 0; i < points.x.length; ++i) {
      const px = this.toX(points.x[i]);
      const py = this.toY(points.y[i]);
      if (Number.isNaN(px) || Number.isNaN(py)) {
        pen = false;
        continue;
      }
      if (pen && Math.abs(px - lastX) + Math.abs(py - lastY) < 0.6) continue;
      if (pen) g.lineTo(px, py);
      else g.moveTo(px, py);
      pen = true;
      lastX = px;
      lastY = py;
    }
  }

  private drawPoint(g: CanvasRenderingContext2D, series: Series, points: Points, i: number) {
    const {spec} = series;
    const y = points.y[i];
    if (Number.isNaN(y) || (this.spec.y.log && y <= 0)) return;
    const px = this.toX(points.x[i]);
    const py = this.toY(y);
    if (spec.kind === 'bars') {
      const w = spec.barWidth ?? 0.8;
      const log = this.plot.x.log;
      const from = this.toX(log ? points.x[i] / Math.sqrt(w) : points.x[i] - w / 2);
      const to = this.toX(log ? points.x[i] * Math.sqrt(w) : points.x[i] + w / 2);
      const zero = this.spec.y.log ? this.box.bottom : this.toY(0);
      g.fillRect(from, Math.min(py, zero), Math.max(to - from - 0.5, 0.5), Math.abs(zero - py));
    } else {
      g.beginPath();
      g.arc(px, py, 3.5, 0, 2 * Math.PI);
      g.fill();
    }
    const error = series.error ? series.error[i] : 0;
    if (!(error > 0)) return;
    const [high, low] = [this.toY(y + error), this.toY(y - error)];
    g.save();
    if (spec.kind === 'bars') g.strokeStyle = style('--ink');
    g.beginPath();
    g.moveTo(px - 4, high);
    g.lineTo(px + 4, high);
    g.moveTo(px, high);
    g.lineTo(px, low);
    g.moveTo(px - 4, low);
    g.lineTo(px + 4, low);
    g.stroke();
    g.restore();
  }

  private drawLimits(g: CanvasRenderingContext2D) {
    const {box} = this;
    const far: string[] = [];
    const near: {py: number; label: string}[] = [];
    for (const limit of this.spec.limits) {
      const py = this.toY(limit.value);
      if (py >= box.top - 0.5 && py <= box.bottom + 0.5) near.push({py, label: limit.label});
      else far.push(limit.label + (py < box.top ? ' ↑' : ' ↓'));
    }
    g.strokeStyle = g.fillStyle = style('--limit');
    g.setLineDash([7, 4]);
    for (const {py} of near) {
      g.beginPath();
      g.moveTo(box.left, py);
      g.lineTo(box.right, py);
      g.stroke();
    }
    g.setLineDash([]);
    g.textAlign = 'right';
    const heights: number[] = [];
    for (const {py, label} of near) {
      const at = heightOfWords(py, near.map((limit) => limit.py), heights, box);
      heights.push(at);
      words(g, label, box.right - 4, at);
    }
    setText(this.far, far.join(', '));
  }

  private drawMarks(g: CanvasRenderingContext2D) {
    g.strokeStyle = g.fillStyle = style('--ink');
    for (const mark of this.spec.marks) {
      const px = this.toX(mark.x);
      const py = this.toY(mark.y);
      if (px < this.box.left || px > this.box.right || py < this.box.top || py > this.box.bottom) continue;
      g.beginPath();
      g.arc(px, py, 3.5, 0, 2 * Math.PI);
      g.stroke();
      const left = px + 8 + g.measureText(mark.label).width > this.box.right;
      g.textAlign = left ? 'right' : 'left';
      words(g, mark.label, px + (left ? -7 : 7), Math.max(py - 5, this.box.top + 12));
    }
  }
}

export class Chart {
  readonly panels: Panel[];
  readonly element: HTMLElement;
  private readonly reset: HTMLButtonElement;
  visible = false;
  private view: Range | null = null;     // of x; null: all
  private viewY: Range | null = null;    // with equal axes
  private waiting = false;
  private drag: {panel: Panel; x: number; y: number} | null = null;

  // zoomed: that the view was changed here; pointed: where the cursor is, for others of the group.
  constructor(readonly spec: PlotSpec, private readonly zoomed: (view: Range | null) => void,
              private readonly pointed: (x: number | null) => void) {
    this.panels = spec.panels.map((panel, i) => new Panel(
        spec, panel, i === 0, i + 1 === spec.panels.length, () => this.redraw()));
    this.reset = h('button', {type: 'button', class: 'reset', disabled: true,
                              onclick: () => this.choose(null, null)}, 'Whole view');
    this.element = h(
        'div', {class: 'live', tabindex: '0', role: 'group',
                'aria-label': 'Plot: drag to zoom, double-click for the whole view'},
        ...this.panels.map((panel) => panel.element), h('div', {class: 'tools'}, this.reset));
    this.panels.forEach((panel) => this.listen(panel));
    this.element.addEventListener('keydown', (event) => this.onKey(event));
    new ResizeObserver(() => this.redraw()).observe(this.element);
  }

  setView(view: Range | null) {
    this.view = view;
    this.redraw();
  }

  setCursor(x: number | null) {
    if (this.visible && !this.spec.equal) this.panels.forEach((panel) => panel.showValues(x));
  }

  redraw() {
    if (this.waiting || !this.visible) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  private draw() {
    const width = this.element.clientWidth;
    if (width < 120) return;
    const [low, high] = this.spec.range;
    const x = this.view ?? {low, high};
    this.reset.disabled = !this.view && !this.viewY;
    for (const panel of this.panels) {
      panel.x = x;
      panel.y = this.viewY ?? yRange(panel.spec.y, panel.dataRange(),
                                     panel.spec.limits.map((limit) => limit.value));
      const height = this.spec.equal ? this.fitEqual(panel, width) : kHeight * panel.spec.height;
      const rows = panel.first ? this.noteRows(panel, width) : [];
      const g = panel.resize(width, height, rows.length > 0 ? kRow * (Math.max(...rows) + 1) : 0);
      panel.draw(g, () => this.drawNoteLines(g, panel, rows));
      if (panel.first) this.drawNoteWords(g, panel, rows);
    }
  }

  // A metre is as long in y as in x: the range that is short is widened. Returns the height.
  private fitEqual(panel: Panel, width: number): number {
    const w = width - kLeft - kRight;
    const [dx, dy] = [panel.x.high - panel.x.low, panel.y.high - panel.y.low];
    const height = Math.min(Math.max(dy / dx * w, 120), 0.62 * width);
    const aPx = Math.max(dx / w, dy / height);
    const [wider, higher] = [(aPx * w - dx) / 2, (aPx * height - dy) / 2];
    panel.x = {low: panel.x.low - wider, high: panel.x.high + wider};
    panel.y = {low: panel.y.low - higher, high: panel.y.high + higher};
    return height;
  }

  // Rows above the first panel in which no two notes overlap; −1: out of view.
  private noteRows(panel: Panel, width: number): number[] {
    const g = panel.canvas.getContext('2d')!;
    g.font = kFont;
    panel.box.left = kLeft;
    panel.box.right = width - kRight;
    const ends: number[] = [];
    return this.spec.notes.map((note) => {
      if (note.x < panel.x.low || note.x > panel.x.high) return -1;
      const length = g.measureText(note.label).width + 8;
      const at = Math.max(kLeft, Math.min(panel.toX(note.x), width - kRight - length));
      let row = ends.findIndex((end) => end <= at);
      if (row < 0) row = ends.push(0) - 1;
      ends[row] = at + length;
      return row;
    });
  }

  private shownNotes(panel: Panel, rows: number[]) {
    const {left, right} = panel.box;
    return this.spec.notes.map((note, i) => ({...note, row: rows[i], px: panel.toX(note.x)}))
        .filter(({px}) => px >= left - 0.5 && px <= right + 0.5);
  }

  private drawNoteLines(g: CanvasRenderingContext2D, panel: Panel, rows: number[]) {
    g.strokeStyle = style('--quiet');
    g.setLineDash([3, 3]);
    for (const {px, row} of this.shownNotes(panel, rows)) {
      g.beginPath();
      g.moveTo(px, panel.first ? kRow * (row + 0.5) : panel.box.top);
      g.lineTo(px, panel.box.bottom);
      g.stroke();
    }
    g.setLineDash([]);
  }

  private drawNoteWords(g: CanvasRenderingContext2D, panel: Panel, rows: number[]) {
    g.fillStyle = style('--quiet');
    g.textAlign = 'left';
    for (const {px, row, label} of this.shownNotes(panel, rows)) {
      const width = g.measureText(label).width + 8;
      words(g, label, Math.max(kLeft, Math.min(px, panel.box.right - width)) + 4, kRow * (row + 0.8));
    }
  }

  private choose(view: Range | null, viewY: Range | null) {
    this.viewY = viewY;
    this.view = view;
    this.redraw();
    this.zoomed(view);
  }

  private zoomBy(factor: number, about: number) {
    const [low, high] = this.spec.range;
    const now = this.view ?? {low, high};
    if (this.spec.x.log || this.spec.equal) return;
    const next = {low: about - (about - now.low) * factor, high: about + (now.high - about) * factor};
    next.low = Math.max(next.low, low);
    next.high = Math.min(next.high, high);
    this.choose(next.low <= low && next.high >= high ? null : next, null);
  }

  private listen(panel: Panel) {
    const {canvas} = panel;
    const place = (event: PointerEvent | WheelEvent | MouseEvent) => {
      const box = canvas.getBoundingClientRect();
      return {x: event.clientX - box.left, y: event.clientY - box.top};
    };
    canvas.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      this.drag = {panel, ...place(event)};
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener('pointermove', (event) => {
      const at = place(event);
      if (this.drag) this.select(at);
      this.point(panel, at);
    });
    canvas.addEventListener('pointerup', (event) => this.release(place(event)));
    canvas.addEventListener('pointercancel', () => this.endDrag());
    canvas.addEventListener('pointerleave', () => {
      this.pointed(null);
      this.panels.forEach((p) => p.showValues(null));
    });
    canvas.addEventListener('dblclick', () => this.choose(null, null));
    canvas.addEventListener('wheel', (event) => {
      if (!event.ctrlKey && !event.metaKey) return;  // else the page scrolls
      event.preventDefault();
      this.zoomBy(Math.exp(0.002 * event.deltaY), panel.fromX(place(event).x));
    }, {passive: false});
  }

  private point(panel: Panel, at: {x: number; y: number}) {
    if (at.x < panel.box.left || at.x > panel.box.right) return;
    if (!this.spec.equal) return this.pointed(panel.fromX(at.x));
    // Of each path the point next to the cursor.
    panel.showValues(null, panel.series.map((series) => {
      const {x, y} = series.points;
      let best = 20 ** 2;
      let found = -1;
      for (let i = 0; i < x.length; ++i) {
        const d = (panel.toX(x[i]) - at.x) ** 2 + (panel.toY(y[i]) - at.y) ** 2;
        if (d < best) [best, found] = [d, i];
      }
      return found < 0 ? '' : `${readable(x[found])}, ${readable(y[found])}`;
    }));
  }

  private select(at: {x: number; y: number}) {
    const {panel, x, y} = this.drag!;
    const {box, selection} = panel;
    const left = Math.max(Math.min(x, at.x), box.left);
    const right = Math.min(Math.max(x, at.x), box.right);
    const top = this.spec.equal ? Math.max(Math.min(y, at.y), box.top) : box.top;
    const bottom = this.spec.equal ? Math.min(Math.max(y, at.y), box.bottom) : box.bottom;
    selection.hidden = right - left < kLeastDrag;
    Object.assign(selection.style, {left: `${left}px`, top: `${top}px`, width: `${right - left}px`,
                                    height: `${bottom - top}px`});
  }

  private release(at: {x: number; y: number}) {
    const drag = this.drag;
    this.endDrag();
    if (!drag || Math.abs(at.x - drag.x) < kLeastDrag) return;
    const {panel} = drag;
    const clamp = (px: number) => Math.min(Math.max(px, panel.box.left), panel.box.right);
    const [a, b] = [panel.fromX(clamp(drag.x)), panel.fromX(clamp(at.x))];
    const view = {low: Math.min(a, b), high: Math.max(a, b)};
    if (!this.spec.equal) return this.choose(view, null);
    const [c, d] = [panel.fromY(drag.y), panel.fromY(at.y)];
    this.choose(view, {low: Math.min(c, d), high: Math.max(c, d)});
  }

  private endDrag() {
    if (this.drag) this.drag.panel.selection.hidden = true;
    this.drag = null;
  }

  private onKey(event: KeyboardEvent) {
    const [low, high] = this.spec.range;
    const {low: a, high: b} = this.view ?? {low, high};
    const pan = (by: number) => {
      const step = Math.max(Math.min(by * (b - a), high - b), low - a);
      this.choose({low: a + step, high: b + step}, null);
    };
    if (event.key === '+') this.zoomBy(0.5, (a + b) / 2);
    else if (event.key === '-') this.zoomBy(2, (a + b) / 2);
    else if (event.key === '0' || event.key === 'Escape') this.choose(null, null);
    else if (event.key === 'ArrowLeft' && this.view && !this.spec.equal) pan(-0.2);
    else if (event.key === 'ArrowRight' && this.view && !this.spec.equal) pan(0.2);
    else return;
    event.preventDefault();
  }
}
