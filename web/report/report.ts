// The report's page: makes the plots interactive as they come into view.
import {Range} from './axis';
import {Chart, forgetColors} from './chart';
import {PlotSpec} from './spec';

const kMargin = '400px';  // around the window, in which plots are made ready

const specs: PlotSpec[] = JSON.parse(document.getElementById('plots')!.textContent!);
const charts = new Map<string, Chart>();
const views = new Map<string, Range | null>();  // by group

function together(group: string): Chart[] {
  return [...charts.values()].filter((chart) => chart.spec.group === group);
}

function make(spec: PlotSpec, figure: HTMLElement): Chart {
  const others = () => (spec.group ? together(spec.group) : [charts.get(spec.id)!]);
  const chart = new Chart(
      spec,
      (view) => {
        if (!spec.group) return;
        views.set(spec.group, view);
        others().forEach((other) => other !== chart && other.setView(view));
      },
      (x) => others().forEach((other) => other.setCursor(x)));
  figure.querySelector('.drawing')!.after(chart.element);
  figure.classList.add('is-live');
  charts.set(spec.id, chart);
  return chart;
}

const byId = new Map(specs.map((spec) => [spec.id, spec]));
const watcher = new IntersectionObserver((entries) => {
  for (const {target, isIntersecting} of entries) {
    let chart = charts.get(target.id);
    if (!chart && isIntersecting) chart = make(byId.get(target.id)!, target as HTMLElement);
    if (!chart) continue;
    chart.visible = isIntersecting;
    if (isIntersecting) chart.setView((chart.spec.group && views.get(chart.spec.group)) || null);
  }
}, {rootMargin: kMargin});
document.querySelectorAll<HTMLElement>('figure.plot').forEach((figure) => watcher.observe(figure));

// Dark or light: as the system has it until the person chooses.
const button = document.getElementById('theme') as HTMLButtonElement;
const dark = matchMedia('(prefers-color-scheme: dark)');
const redraw = () => {
  forgetColors();
  charts.forEach((chart) => chart.redraw());
};
button.hidden = false;
button.addEventListener('click', () => {
  const {dataset} = document.documentElement;
  const now = dataset.theme ?? (dark.matches ? 'dark' : 'light');
  dataset.theme = now === 'dark' ? 'light' : 'dark';
  redraw();
});
dark.addEventListener('change', redraw);
