// Shows the results for the person: gauges with their intervals, classes of the worksheets, damage,
// fatigue and warnings.
import {h, setAttribute, setText} from '../dom';
import {loadColor} from '../load';
import {inputLines, kArmParts, kHeadWords, kWhyNot} from '../person';
import {kPersonGauges, kPersonScores, kPersonWarnings, PersonState, SceneSpec} from '../protocol';
import {hex} from '../theme';
import {fixed} from '../words';

type GaugeName = keyof typeof kPersonGauges;
type ScoreName = keyof typeof kPersonScores;

const kRoom = [1100, 700];  // window in which the card is open at first [px]
const kLateStart = 0.5;  // if damage is counted from later than this, the card says from when [s]
const kEveryMs = 100;  // time between updates; warnings appear at once

// The properties of a gauge, which are its words, the factor from SI units, the number of decimals,
// and the ends of its bar in SI units.
interface GaugeLook {
  words: string;
  unit: string;
  factor: number;
  decimals: number;
  low: number;
  high: number;
}
const kDegrees = 180 / Math.PI;
const share = (words: string): GaugeLook => ({words, unit: '%', factor: 100, decimals: 0, low: 0, high: 1.2});
const activation = (words: string): GaugeLook => ({words, unit: '%', factor: 100, decimals: 0, low: 0, high: 1});
const stiffness = (words: string): GaugeLook => ({words, unit: 'N/m', factor: 1, decimals: 0, low: 0, high: 200});
const force = (words: string): GaugeLook => ({words, unit: 'N', factor: 1, decimals: 0, low: 0, high: 50});
export const kGaugeLooks: Record<GaugeName, GaugeLook> = {
  left_hand_force: force('Left hand'),
  right_hand_force: force('Right hand'),
  lower_back_compression: {words: 'Back, compression', unit: 'N', factor: 1, decimals: 0, low: 0, high: 4200},
  lower_back_shear: {words: 'Back, shear', unit: 'N', factor: 1, decimals: 0, low: 0, high: 850},
  lower_back_moment: {words: 'Back, moment', unit: 'N·m', factor: 1, decimals: 0, low: 0, high: 200},
  left_shoulder_use: share('Left shoulder'),
  right_shoulder_use: share('Right shoulder'),
  left_elbow_use: share('Left elbow'),
  right_elbow_use: share('Right elbow'),
  trunk_flexion: {words: 'Trunk, forward', unit: '°', factor: kDegrees, decimals: 0, low: -0.35, high: 1.6},
  balance_margin: {words: 'Balance margin', unit: 'cm', factor: 100, decimals: 1, low: -0.05, high: 0.15},
  left_arm_activation: activation('Left arm activation'),
  right_arm_activation: activation('Right arm activation'),
  left_hand_stiffness: stiffness('Left hand stiffness'),
  right_hand_stiffness: stiffness('Right hand stiffness'),
};
const from = (source: string) =>
    (Object.keys(kGaugeLooks) as GaugeName[]).filter((name) => kPersonGauges[name].source === source);
const kOperator: Record<SceneSpec['operator'], string> = {
  virtual: 'The operator is simulated.',
  browser: 'A mouse or a headset moves the handles: the values are those of a person who would hold them.',
  person: 'A person holds the handles.',
};

export function gaugeText(look: GaugeLook, value: number | null): string {
  if (value === null) return '–';
  return `${fixed(look.factor * value, look.decimals)} ${look.unit}`;
}

// Shows a value on a bar, with its 90 % interval as a band and its limit as a mark.
class Gauge {
  readonly element: HTMLElement;
  private readonly look: GaugeLook;
  private readonly text = h('output', {}, '–');
  private readonly band = h('i', {class: 'band'});
  private readonly bar = h('i', {class: 'value'});
  private readonly limit = h('i', {class: 'limit'});
  private high: number;

  constructor(private readonly name: GaugeName) {
    this.look = kGaugeLooks[name];
    this.high = this.look.high;
    const {meaning, limit, lowIsBad} = kPersonGauges[name];
    this.limit.hidden = limit === 0 && !lowIsBad;
    this.element = h(
        'div', {class: 'person-gauge', id: `gauge-${name}`, title: meaning}, h('span', {}, this.look.words),
        h('div', {class: 'person-bar'}, this.band, this.bar, this.limit), this.text);
    this.limit.style.left = this.at(limit);
  }

  show({value, low, high}: PersonState['gauges'][GaugeName]) {
    setText(this.text, gaugeText(this.look, value));
    const top = Math.max(value ?? 0, high ?? 0);
    if (top > this.high) this.high = 1.2 * top;  // the bar grows with the largest value
    const {limit, lowIsBad} = kPersonGauges[this.name];
    this.limit.style.left = this.at(limit);
    const beyond = value !== null && !this.limit.hidden && (lowIsBad ? value < limit : value > limit);
    setAttribute(this.element, 'data-beyond', String(beyond));
    this.bar.hidden = value === null;
    this.band.hidden = low === null || high === null;
    setAttribute(this.element, 'data-interval',
                 low === null || high === null ? '' : `${gaugeText(this.look, low)} … ${gaugeText(this.look, high)}`);
    this.bar.style.left = this.at(value ?? 0);
    this.band.style.left = this.at(low ?? 0);
    this.band.style.right = `calc(100% - ${this.at(high ?? 0)})`;
  }

  private at(x: number): string {
    const part = (x - this.look.low) / (this.high - this.look.low);
    return `${(100 * Math.min(Math.max(part, 0), 1)).toFixed(1)}%`;
  }
}

// Shows the present score of a worksheet, and the probability of each action level as a bar.
class ScoreRow {
  readonly element: HTMLElement;
  private readonly score = h('output', {}, '–');
  private readonly levels: HTMLElement[];

  constructor(name: ScoreName) {
    const {levels, most} = kPersonScores[name];
    this.levels = Array.from({length: levels}, (_, i) => {
      const part = h('i', {});
      const severity = i / (levels - 1);
      part.style.background = hex(loadColor(severity));
      if (severity > 0.7) part.style.color = '#fff';
      return part;
    });
    this.element = h(
        'div', {class: 'person-score', id: `score-${name}`, title: `Scores of 1 to ${most}; action levels of 1 to ${levels}`},
        h('b', {}, name.toUpperCase()), this.score, h('div', {class: 'person-levels'}, ...this.levels));
  }

  show({score, level, probability}: PersonState['scores'][ScoreName]) {
    setText(this.score, score === 0 ? '–' : `${score}`);
    this.levels.forEach((part, i) => {
      const p = probability?.[i] ?? (probability === null && level === i + 1 ? 1 : 0);
      part.style.flexGrow = String(p);
      part.classList.toggle('now', level === i + 1);
      setText(part, p > 0.2 ? `${i + 1}: ${(100 * p).toFixed(0)} %` : '');
      part.title = `Action level ${i + 1}: ${(100 * p).toFixed(0)} %`;
    });
  }
}

export class PersonCard {
  readonly element: HTMLElement;
  private readonly why = h('p', {class: 'hint', id: 'person-why', role: 'status'});
  private readonly operator = h('p', {class: 'hint', id: 'person-operator'});
  private readonly warnings = h('div', {id: 'person-warnings', role: 'alert'});
  private readonly gauges = new Map((Object.keys(kGaugeLooks) as GaugeName[]).map((name) => [name, new Gauge(name)]));
  private readonly scores = new Map(
      (Object.keys(kPersonScores) as ScoreName[]).map((name) => [name, new ScoreRow(name)]));
  private readonly head = h('p', {class: 'hint', id: 'person-head'});
  private readonly inputs = h('div', {id: 'person-inputs'});
  private readonly damage = h('p', {id: 'person-damage'});
  private readonly fatigue = h('p', {id: 'person-fatigue'});
  private readonly short = h('span', {class: 'hint'});  // beside the title, if the card is closed
  private readonly body: HTMLElement;
  private spec: SceneSpec | null = null;
  private drawnMs = -Infinity;
  private shown = '';

  constructor() {
    const rows = (names: GaugeName[]) => names.map((name) => this.gauges.get(name)!.element);
    const title = (words: string, origin: string) => h('h4', {}, words, h('span', {class: 'tag'}, origin));
    const scale = h('i', {class: 'person-scale'});
    scale.style.background = `linear-gradient(to right, ${[0, 0.5, 1].map((x) => hex(loadColor(x))).join()})`;
    this.body = h(
        'div', {class: 'person-body'},
        h('p', {class: 'hint legend'}, 'Load 0', scale, '100 % of limit or strength'),
        title('Hands', 'measured'), ...rows(from('measured')), this.inputs,
        title('Body', 'modelled, 90 % band'), this.head, ...rows(from('modelled')),
        title('Scores', 'standard, probability'), ...[...this.scores.values()].map(({element}) => element),
        title('Muscles', 'modelled, lower bounds'), ...rows(from('muscles')),
        title('This run so far', 'standard'), this.damage, this.fatigue);
    // The card is open at first if there is room next to the objects of the scene.
    const open = innerWidth >= kRoom[0] && innerHeight >= kRoom[1];
    this.element = h(
        'div', {class: 'person', id: 'person', hidden: true}, this.warnings,
        h('details', {open}, h('summary', {}, h('b', {}, 'Person'), this.short), this.why, this.operator, this.body));
  }

  // Returns the share of the scene's width that the open card covers, from the left.
  covered(scene: HTMLElement): number {
    if (!this.element.querySelector('details')!.open) return 0;
    return this.element.offsetWidth === 0 ? 0 :
      (this.element.offsetLeft + this.element.offsetWidth) / Math.max(scene.clientWidth, 1);
  }

  build(spec: SceneSpec) {
    this.spec = spec;
    this.element.hidden = !spec.person || spec.results !== undefined;
    setText(this.operator, spec.person?.judged ? kOperator[spec.operator] : '');
    this.show(null, false, Infinity);
  }

  // `person` is the newest state of the person, or null if no state has arrived yet. `silent`
  // states whether no state has arrived for too long.
  show(person: PersonState | null, silent: boolean, nowMs: number, over = false) {
    const judged = this.spec?.person?.judged ?? false;
    const why = !judged ? `Not judged: ${this.spec?.person?.why ?? 'the body or its place is not known.'}` :
        !person ? 'Waiting for the evaluation.' :
        silent ? (over ? 'The run is over: these are its last values.' :
                         'The evaluator has stopped sending: these values are old.') :
        person.status === 'judged' ? '' : kWhyNot[person.status];
    const warnings = silent ? [] : person?.warnings ?? [];
    const text = `${why} ${warnings.join()}`;
    if (text === this.shown && nowMs - this.drawnMs < kEveryMs) return;
    this.shown = text;
    this.drawnMs = nowMs;
    setText(this.why, why);
    setText(this.short, judged ? '' : 'not judged');
    this.body.hidden = !judged || !person;
    this.body.classList.toggle('old', silent || person?.status !== 'judged');
    this.warnings.replaceChildren(...warnings.map((name) => h('p', {'data-warning': name}, kPersonWarnings[name].words)));
    if (!person) return;
    for (const [name, gauge] of this.gauges) gauge.show(person.gauges[name]);
    for (const [name, row] of this.scores) row.show(person.scores[name]);
    setText(this.head, person.status === 'judged' && person.head ? kHeadWords[person.head] : '');
    this.inputs.replaceChildren(...inputLines(person).map(({text, bad}) => h('p', {class: bad ? 'hint bad' : 'hint'}, text)));
    setText(this.damage, damageText(person));
    setText(this.fatigue, fatigueText(person));
  }
}

// Describes the damage that the run has caused so far, or that each repetition causes if the run is
// repeated.
export function damageText({parts, since}: PersonState): string {
  const cost = (name: keyof PersonState['parts']) => {
    const {day_share: share, load_over_range: range} = parts[name];
    const mark = range !== null && range > 1 ? ' (beyond the range of the method)' : '';
    return share === null ? null : `${name.replace('_', ' ')} ${(100 * share).toPrecision(2)} %${mark}`;
  };
  const costs = (['lower_back', 'left_shoulder', 'right_shoulder'] as const).map(cost).filter((text) => text !== null);
  return costs.length === 0 ? '' : `Damage${since !== null && since > kLateStart ? ` since ${since.toFixed(0)} s` : ''}, as a share of a reference day: ${costs.join(', ')}.`;
}

export function fatigueText({parts}: PersonState): string {
  const left = kArmParts.flatMap((name) => {
    const {capacity} = parts[name];
    return capacity === null ? [] : [`${name.replace('_', ' ')} ${(100 * capacity).toFixed(0)} %`];
  });
  return left.length === 0 ? '' : `Strength left (modelled): ${left.join(', ')}.`;
}
