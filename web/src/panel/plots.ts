// Shows live plots of the last seconds, which the person can pause, zoom and save.
import {h, setText} from '../dom';
import {SceneSpec, stampMs, State} from '../protocol';
import {kPlots, Plot, PlotSpec} from './plot';
import {save} from './save';

const kWindows = [10, 30, 60];  // [s]
const kKeptSeconds = 66;
const kGapSeconds = 0.5;        // a longer gap between states interrupts the line
const kRedrawMs = 120;
const kHint = 'drag to zoom';

export class Plots {
  readonly element: HTMLElement;
  paused = false;
  window = 10;  // [s]
  private zoomed: [number, number] | null = null;
  private times: number[] = [];
  private readonly plots: Plot[] = [];
  private readonly cursorText = h('span', {class: 'hint', id: 'plots-cursor', role: 'status'}, kHint);
  private readonly pauseButton: HTMLButtonElement;
  private readonly windowButtons: HTMLButtonElement[];
  private readonly waiting: [State, SceneSpec, number][] = [];  // while paused
  private lastDrawMs = 0;

  constructor() {
    const groups = kPlots.map((group) => this.buildGroup(group));
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
          ...this.windowButtons, this.cursorText, h('span', {class: 'spacer'}),
          h('button', {class: 'small', id: 'save-plots', title: 'Save the plots as an image (PNG)',
                       onclick: () => void this.savePicture()}, 'Save plots'),
          h('button', {class: 'small', id: 'save-table', title: 'What the plots show, as a table (CSV)',
                       onclick: () => this.saveTable()}, 'Save table')),
        h('div', {class: 'plots'}, ...groups));
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

  // Call this function after a reconnection or a restart, because the times may start again at
  // zero.
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

  // Returns the visible range of time [s], relative to the newest time.
  shownRange(): [number, number] {
    const [min, max] = this.range();
    const last = this.times.at(-1) ?? 0;
    return [min - last, max - last];
  }

  get points(): number {
    return this.times.length;
  }

  // Returns the values of all plots in the visible time range.
  table(): string {
    const [min, max] = this.range();
    const columns = this.plots.flatMap(({spec, columns: values}) => spec.series.map(
        (s, i) => ({head: `${s.name} [${spec.unit}]`, values: values[i]})));
    const rows = [['time [s]', ...columns.map(({head}) => head)].join()];
    const last = this.times.at(-1) ?? 0;
    this.times.forEach((time, i) => {
      if (time < min || time > max) return;
      const cells = columns.map(({values}) => (values[i] === null ? '' : values[i].toPrecision(6)));
      rows.push([(time - last).toFixed(4), ...cells].join());
    });
    return `${rows.join('\n')}\n`;
  }

  private saveTable() {
    save('plots.csv', new Blob([this.table()], {type: 'text/csv'}));
  }

  // Saves the visible plots side by side, each under its caption.
  private async savePicture() {
    const shown = this.plots.filter((plot) => !plot.element.hidden);
    const style = getComputedStyle(this.element);
    const scale = devicePixelRatio;
    const caption = 22 * scale;
    const picture = document.createElement('canvas');
    picture.width = shown.reduce((sum, {canvas}) => sum + canvas.width, 0);
    picture.height = caption + Math.max(...shown.map(({canvas}) => canvas.height));
    const c = picture.getContext('2d')!;
    c.fillStyle = style.backgroundColor;
    c.fillRect(0, 0, picture.width, picture.height);
    c.fillStyle = style.color;
    c.font = `600 ${12 * scale}px system-ui, sans-serif`;
    let x = 0;
    for (const {spec, canvas} of shown) {
      c.fillText(`${spec.title} [${spec.unit}]`, x + 8 * scale, caption - 7 * scale);
      c.drawImage(canvas, x, caption);
      x += canvas.width;
    }
    const blob = await new Promise<Blob | null>((resolve) => picture.toBlob(resolve));
    if (blob) save('plots.png', blob);
  }

  // Builds a group of plots. One plot of the group is visible at a time. Each plot has a button
  // that shows the plot.
  private buildGroup(specs: PlotSpec[]): HTMLElement {
    const plots: Plot[] = [];
    const show = (seen: number) => plots.forEach(({element}, i) => (element.hidden = i !== seen));
    specs.forEach((spec, own) => {
      const next = (own + 1) % specs.length;
      const button = h('button', {
        class: 'swap', id: `show-${specs[next].id}`, title: `Show: ${specs[next].title}`,
        onclick: () => {
          show(next);
          plots[next].element.querySelector<HTMLElement>('.swap')?.focus();
        },
      }, `${spec.title} ⇄`);
      plots.push(new Plot(spec, specs.length > 1 ? button : h('b', {}, spec.title),
                          (min, max) => this.zoom(min, max), (time) => this.showCursor(time)));
    });
    show(0);
    this.plots.push(...plots);
    return h('div', {class: 'plot-group'}, ...plots.map(({element}) => element));
  }

  private showCursor(time: number | null) {
    const ago = time === null ? NaN : time - (this.times.at(-1) ?? time);
    setText(this.cursorText, Number.isNaN(ago) ? kHint : `at ${ago.toFixed(2)} s`);
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
