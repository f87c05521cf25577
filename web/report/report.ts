// Makes the plots of the report's page interactive when they come into view.
import {Chart} from './chart';
import {PlotSpec, Range} from './data';

const kMargin = '100px';  // margin around the window in which plots are prepared

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
  figure.querySelector('.drawing')!.replaceChildren(chart.element);
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
    if (!isIntersecting) continue;
    if (chart.spec.group) chart.setView(views.get(chart.spec.group) ?? null);
    else chart.redraw();
  }
}, {rootMargin: kMargin});
document.querySelectorAll<HTMLElement>('figure.plot').forEach((figure) => watcher.observe(figure));

// The style is dark or light according to the system's setting, until the person chooses one of
// them.
const button = document.getElementById('theme') as HTMLButtonElement;
const dark = matchMedia('(prefers-color-scheme: dark)');
const redraw = () => charts.forEach((chart) => chart.redraw());
button.hidden = false;
button.addEventListener('click', () => {
  const {dataset} = document.documentElement;
  const now = dataset.theme ?? (dark.matches ? 'dark' : 'light');
  dataset.theme = now === 'dark' ? 'light' : 'dark';
  redraw();
});
dark.addEventListener('change', redraw);

// For printing, all plots are drawn, including those that were never visible.
const paper = matchMedia('print');
const onPaper = () => {
  if (!paper.matches) return redraw();
  for (const spec of specs) (charts.get(spec.id) ?? make(spec, document.getElementById(spec.id)!)).draw();
};
paper.addEventListener('change', onPaper);
