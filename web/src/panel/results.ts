// Shows how a run ended, its results as numbers and curves, and the next steps that are available.
import uPlot from 'uplot';
import {h, setAttribute, setText} from '../dom';
import {Curve, Figure, kSides, Results, SceneSpec, Side} from '../protocol';
import {hex, kMeaning} from '../theme';

export interface ResultsActions {
  run(scenario: string): void;
  saveReport(): void;
}

// Returns the scenario after the present one in the list, or null if the present one is not in the
// list.
export function nextScenario(spec: SceneSpec): {name: string; title: string} | null {
  const at = spec.scenarios.findIndex(({name}) => name === spec.file);
  return at < 0 || spec.scenarios.length < 2 ? null : spec.scenarios[(at + 1) % spec.scenarios.length];
}

export class ResultsCard {
  readonly element: HTMLElement;
  private readonly title = h('h2', {id: 'results-title'});
  private readonly how = h('p', {class: 'results-how', id: 'results-how'});
  private readonly cause = h('p', {class: 'results-cause', id: 'results-cause'});
  private readonly figures = h('table', {id: 'results-figures'});
  private readonly curves = h('div', {class: 'results-curves'});
  private readonly remark = h('p', {class: 'hint', id: 'results-remark'});
  private readonly again = h('button', {class: 'primary', id: 'run-again'}, 'Run again');
  private readonly next = h('button', {id: 'run-next'}, 'Next scenario');
  private readonly report = h('button', {id: 'save-report'}, 'Save report');
  private plots: uPlot[] = [];
  private spec: SceneSpec | null = null;

  constructor(actions: ResultsActions) {
    const run = (scenario?: string) => {
      this.again.disabled = this.next.disabled = true;
      if (scenario) actions.run(scenario);
    };
    this.again.addEventListener('click', () => run(this.spec?.file));
    this.next.addEventListener('click', () => run(this.spec ? nextScenario(this.spec)?.name : undefined));
    this.report.addEventListener('click', () => actions.saveReport());
    this.element = h(
        'section', {class: 'results', id: 'results', 'aria-label': 'Results', hidden: true},
        h('header', {}, h('div', {}, this.title, this.how, this.cause),
          h('button', {class: 'small', id: 'hide-results', title: 'Show the scene',
                       onclick: () => this.show(false)}, 'Show the scene')),
        h('div', {class: 'results-actions'}, this.again, this.next, this.report), this.remark,
        h('div', {class: 'results-body'}, this.figures, this.curves));
    new ResizeObserver(() => this.fit()).observe(this.curves);
  }

  build(spec: SceneSpec) {
    this.spec = spec;
    const {results} = spec;
    this.clear();
    this.show(results !== undefined);
    if (!results) return;
    setText(this.how, results.how);
    const next = nextScenario(spec);
    this.next.hidden = next === null;
    setText(this.next, next ? `Next: ${next.title}` : '');
    this.next.title = next?.title ?? '';
    this.report.hidden = !results.report;
    setText(this.remark, results.remark);
    this.figures.replaceChildren(...figureRows(results));
    this.curves.replaceChildren(...results.curves.map((curve) => this.figure(curve)));
  }

  // `stopped` and `cause` state whether and why the run was stopped. `may` states whether this page
  // may choose the next scenario. `alive` states whether the program is still running and can start
  // this scenario.
  update(title: string, stopped: boolean, cause: string, may: boolean, alive: boolean) {
    if (!this.spec?.results) return;
    setText(this.title, title);
    setAttribute(this.title, 'data-tone', stopped ? 'stopped' : 'ready');
    setText(this.cause, cause);
    const listed = this.spec.scenarios.some(({name}) => name === this.spec?.file);
    this.again.hidden = !alive || !listed;
    this.next.hidden = !alive || nextScenario(this.spec) === null;
    if (!alive) this.report.hidden = true;
    for (const button of [this.again, this.next]) {
      button.disabled = !may;
      button.title = may ? '' : 'Another page has control of the run.';
    }
  }

  get isShown(): boolean {
    return !this.element.hidden;
  }

  show(on: boolean) {
    this.element.hidden = !on;
    if (on) this.fit();
  }

  repaint() {
    for (const plot of this.plots) plot.redraw(false, true);
  }

  private clear() {
    for (const plot of this.plots) plot.destroy();
    this.plots = [];
    this.curves.replaceChildren();
  }

  private figure(curve: Curve): HTMLElement {
    const holder = h('div', {class: 'canvas'});
    const sides = kSides.filter((side) => curve[side]);
    const element = h(
        'figure', {class: 'plot'},
        h('figcaption', {}, h('b', {}, `${curve.title} [${curve.unit}]`),
          h('span', {class: 'legend'}, ...sides.map((side) => key(side, hex(kMeaning[side]))),
            key('limit', hex(kMeaning.red)))),
        holder);
    this.plots.push(new uPlot(options(curve, sides), columns(curve, sides), holder));
    return element;
  }

  private fit() {
    for (const plot of this.plots) {
      const holder = plot.root.parentElement!;
      if (holder.clientWidth > 40) plot.setSize({width: holder.clientWidth, height: 150});
    }
  }
}

function key(name: string, color: string): HTMLElement {
  const item = h('span', {class: name === 'limit' ? 'key dashed' : 'key'}, h('span', {class: 'name'}, name));
  item.style.setProperty('--series', color);
  return item;
}

function columns(curve: Curve, sides: Side[]): uPlot.AlignedData {
  const count = Math.max(...sides.map((side) => curve[side]!.length));
  const times = Array.from({length: count}, (_, i) => (i + 0.5) * curve.step);
  return [times, ...sides.map((side) => curve[side]!), times.map(() => curve.limit)];
}

function options(curve: Curve, sides: Side[]): uPlot.Options {
  const style = (name: string) =>
    getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const axis: uPlot.Axis = {
    stroke: () => style('--quiet'), grid: {stroke: () => style('--line'), width: 1},
    ticks: {show: false}, font: '11px system-ui, sans-serif',
  };
  const largest = Math.max(...sides.flatMap((side) => curve[side]!), 0);
  // The plot shows the limit if the values come close to it.
  const top = 1.1 * (largest > 0.3 * curve.limit ? Math.max(largest, curve.limit) : largest || 1);
  return {
    width: 300, height: 150, legend: {show: false},
    cursor: {drag: {x: true, y: false}, y: false},
    scales: {x: {time: false}, y: {range: () => [0, top]}},
    axes: [{...axis, size: 22, gap: 3, values: (_u, ticks) => ticks.map((t) => `${t} s`)},
           {...axis, size: 38, gap: 3, space: 26}],
    series: [
      {},
      ...sides.map((side) => ({stroke: hex(kMeaning[side]), width: 1.6, points: {show: false}})),
      {stroke: hex(kMeaning.red), width: 1.4, dash: [6, 4], points: {show: false}},
    ],
  };
}

function figureRows({figures}: Results): HTMLElement[] {
  const sides = kSides.filter((side) => figures.some((figure) => figure[side] !== undefined));
  const row = (figure: Figure) => h(
      'tr', {}, h('th', {scope: 'row'}, figure.name),
      ...(figure.value !== undefined ?
        [h('td', {colspan: sides.length || 1}, figure.value)] :
        sides.map((side) => h('td', {}, figure[side] ?? '–'))));
  const head = h('tr', {}, h('td', {}), ...sides.map((side) => h('th', {scope: 'col'}, side)));
  return [h('thead', {}, head), h('tbody', {}, ...figures.map(row))];
}
