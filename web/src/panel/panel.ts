// Shows the column next to the scene with the state in words, the stop button, the commands, the
// leases, the sliders and the latency.
import {Connection} from '../connection';
import {h, setAttribute, setText} from '../dom';
import {kSteps, LatencyLedger} from '../latency';
import {Command, kParameters, ParameterName, RunState, SceneSpec, State} from '../protocol';
import {dangerWords, kParameterWords, kTroubles, overWords, stateWords, stopWords, Trouble} from '../words';
import {ParameterSlider} from './slider';
import {Transport} from './transport';

const kCommands: {command: Command; label: string; hint: string; states: RunState[]}[] = [
  {command: 'align', label: 'Align', hint: 'Idle', states: ['IDLE']},
  {command: 'start', label: 'Start', hint: 'Armed', states: ['ARMED']},
  {command: 'end', label: 'End', hint: 'Running', states: ['RUN']},
  {command: 'reset', label: 'Reset', hint: 'Stopped', states: ['HELD', 'UNPOWERED']},
];
// In these states, the arms are at rest, and a page may choose the next scenario.
const kAtRest: RunState[] = ['IDLE', 'HELD', 'UNPOWERED'];
const kLedgerMs = 500;
const kNothingYet = {title: 'Connected', meaning: 'Waiting for the first state.', tone: 'calm'};

export class Panel {
  readonly element: HTMLElement;
  readonly stopButton: HTMLButtonElement;
  private readonly stateCard = h('div', {class: 'state-card'});
  private readonly title = h('h2', {id: 'state', role: 'status', 'aria-live': 'polite'});
  private readonly meaning = h('p', {id: 'meaning'});
  private readonly cause = h('p', {id: 'cause', role: 'alert'});
  private readonly advice = h('p', {id: 'advice'});
  private readonly emergency = h(
      'p', {id: 'emergency', class: 'emergency', role: 'alert', hidden: true},
      'Use the robot’s emergency stop');
  private readonly commands = new Map<Command, HTMLButtonElement>();
  private readonly picker = h('select', {
    id: 'scenario', disabled: true, onchange: () => this.pickScenario(),
  });
  private readonly pickerRow = h(
      'label', {class: 'picker', hidden: true}, h('span', {}, 'Scenario'), this.picker);
  private readonly commandRow = h('div', {class: 'row commands', role: 'group', 'aria-label': 'Commands'});
  private readonly againButton = h('button', {
    id: 'again', hidden: true, title: 'Ends this run and starts it again',
    onclick: () => this.choose(this.file),
  }, 'Run again');
  private readonly resultsButton = h('button', {
    id: 'show-results', class: 'primary', hidden: true, onclick: () => this.showResults(),
  }, 'Show results');
  private file = '';  // file of the scenario
  private readonly commandHint = h('p', {class: 'hint', id: 'command-hint'});
  private readonly leaseButtons = new Map<'control' | 'operator', HTMLButtonElement>();
  private readonly leaseTexts = new Map<'control' | 'operator', HTMLElement>();
  private readonly handsHint = h('p', {id: 'hands-hint', class: 'hint', hidden: true},
    'Drag a handle. Shift: up and down; Ctrl: both handles; wheel: rotate. With the scene in focus: L, R or B ' +
    'takes a handle; arrows and Page ↑ ↓ move it; comma and full stop rotate it.');
  private readonly people = h('p', {id: 'people', class: 'hint'});
  private readonly sliders = new Map<ParameterName, ParameterSlider>();
  private readonly sliderBox = h('div', {class: 'sliders'});
  private readonly markButton = h('button', {
    id: 'mark', class: 'small', disabled: true, 'aria-keyshortcuts': 'M',
    title: 'Marks this moment in the recording (key M)', onclick: () => this.mark(),
  }, 'Mark');
  private readonly ofRuns: HTMLElement[] = [];  // hidden for a recording
  private readonly ledger = new Map(kSteps.map(
      (step) => [step, {p50: h('td', {}, '–'), p99: h('td', {}, '–')}]));
  private readonly latencyText = h('span', {class: 'hint'});
  private readonly clockText = h('p', {class: 'hint', id: 'clock'});
  private lastLedgerMs = 0;
  private commandHadFocus = false;  // a command button had the focus and was then disabled

  readonly transport: Transport;

  constructor(private readonly connection: Connection, private readonly latency: LatencyLedger,
              events: HTMLElement, stop: () => void, private readonly showResults: () => void) {
    this.transport = new Transport(connection);
    this.stopButton = h(
        'button', {id: 'stop', class: 'stop', 'aria-keyshortcuts': 'Space Escape', onclick: stop},
        h('span', {}, 'STOP'), h('kbd', {}, 'Space or Esc'));
    this.element = h(
        'aside', {class: 'panel', 'aria-label': 'Run'},
        h('div', {class: 'pinned'}, this.stopButton, this.transport.element, this.emergency,
          this.buildState(), this.resultsButton),
        h('div', {class: 'scroll', tabindex: 0, 'aria-label': 'Settings'}, events,
          this.buildCommands(), this.buildLeases(), this.ofRun(h('section', {}, h('h3', {}, 'While running'), this.sliderBox)),
          this.buildLedger()));
  }

  // Marks the present time if the page shows a recording.
  mark() {
    if (!this.markButton.disabled) this.connection.send({type: 'mark'});
  }

  build(spec: SceneSpec) {
    this.transport.build(spec);
    this.file = spec.file ?? '';
    for (const element of this.ofRuns) element.hidden = spec.replay !== undefined;
    this.commandRow.hidden = spec.results !== undefined;
    this.sliderBox.parentElement!.hidden ||= spec.results !== undefined;
    this.pickerRow.hidden = spec.scenarios.length < 2;
    this.picker.replaceChildren(...spec.scenarios.map(
        ({name, title}) => h('option', {
          value: name, selected: spec.file ? name === spec.file : title === spec.name,
        }, title)));
    this.sliders.clear();
    this.sliderBox.replaceChildren();
    for (const name of kParameters) {
      const parameter = spec.parameters[name];
      if (!parameter) continue;
      const slider = new ParameterSlider(name, kParameterWords[name], parameter, (value) =>
        this.connection.send({type: 'parameter', parameter: name, value}));
      this.sliders.set(name, slider);
      this.sliderBox.append(slider.element);
    }
  }

  update(state: State | null, spec: SceneSpec | null, nowMs: number, trouble: Trouble | null) {
    const over = trouble === kTroubles.ended || trouble === kTroubles.results || spec?.results !== undefined;
    const mayStop = !over && (trouble === null || trouble.mayStop);
    this.showState(state, spec, trouble, over);
    this.stopButton.hidden = !mayStop || spec?.replay !== undefined;
    const emergency = over && spec?.simulated === false ? 'This page can no longer stop the arms' :
                                                          trouble?.emergency ?? '';
    setText(this.emergency, emergency);
    this.emergency.hidden = emergency === '' || spec?.replay !== undefined;
    this.transport.update(state, nowMs);
    this.markButton.disabled = !(mayStop && state?.recording);
    this.showCommands(mayStop ? state : null, spec, over);
    this.showChoice(state, spec, trouble);
    this.showLeases(spec);
    kParameters.forEach((name, i) =>
      this.sliders.get(name)?.update(state?.parameters[i], this.connection.hasControl, nowMs));
    if (nowMs - this.lastLedgerMs > kLedgerMs) {
      this.lastLedgerMs = nowMs;
      this.showLedger();
    }
  }

  // The results are available, but the page does not show them.
  offerResults(on: boolean) {
    this.resultsButton.hidden = !on;
  }

  get stateText(): string {
    return this.title.textContent ?? '';
  }

  get stopText(): {cause: string; advice: string} {
    return {cause: this.cause.textContent ?? '', advice: this.advice.textContent ?? ''};
  }

  private buildState(): HTMLElement {
    this.stateCard.append(this.title, this.meaning, this.cause, this.advice);
    return this.stateCard;
  }

  private buildCommands(): HTMLElement {
    for (const {command, label, hint} of kCommands) {
      const button = h('button', {
        id: command, disabled: true, title: `Possible when: ${hint}`,
        onclick: () => this.connection.send({type: 'command', command}),
      }, label);
      this.commands.set(command, button);
      this.commandRow.append(button);
    }
    this.commandRow.append(this.markButton);
    return this.ofRun(h('section', {}, h('h3', {}, 'Run'), this.commandRow, this.againButton, this.commandHint,
                        this.pickerRow));
  }

  private ofRun(element: HTMLElement): HTMLElement {
    this.ofRuns.push(element);
    return element;
  }

  private buildLeases(): HTMLElement {
    const row = (what: 'control' | 'operator', label: string) => {
      const text = h('span', {class: 'holder', id: `${what}-holder`});
      const button = h('button', {
        class: 'small', id: `${what}-lease`, onclick: () => this.toggleLease(what),
      });
      this.leaseTexts.set(what, text);
      this.leaseButtons.set(what, button);
      return h('div', {class: 'lease'}, h('span', {}, h('b', {}, label), text), button);
    };
    return h('section', {}, h('h3', {}, 'People'), row('control', 'Control'),
             row('operator', 'Operator’s hands'), this.handsHint, this.people);
  }

  private buildLedger(): HTMLElement {
    const rows = kSteps.map((step) => {
      const {p50, p99} = this.ledger.get(step)!;
      return h('tr', {}, h('th', {scope: 'row'}, step), p50, p99);
    });
    return h(
        'details', {}, h('summary', {}, h('h3', {}, 'Latency'), this.latencyText),
        h('table', {id: 'latency'},
          h('thead', {}, h('tr', {}, h('th', {}, 'ms'), h('th', {scope: 'col'}, 'p50'),
                          h('th', {scope: 'col'}, 'p99'))),
          h('tbody', {}, ...rows)),
        this.clockText);
  }

  private showState(state: State | null, spec: SceneSpec | null, trouble: Trouble | null, over: boolean) {
    const words = trouble ?? (spec?.results ? overWords(state, spec.results.how) :
                              state ? stateWords(state) : kNothingYet);
    setText(this.title, words.title);
    setText(this.meaning, words.meaning);
    const stop = state && (!trouble || over) ? stopWords(state, !!spec?.simulated, over) : null;
    setAttribute(this.stateCard, 'data-tone', over && stop ? 'stopped' : words.tone ?? 'stopped');
    setText(this.cause, stop?.cause ?? '');
    const danger = state && spec && !trouble ? dangerWords(state, spec.simulated) : '';
    setText(this.advice, trouble && over ? '' : danger || (stop?.advice ?? ''));
  }

  // Shows the choice for the next run, which uses the same scenario or another one.
  private showChoice(state: State | null, spec: SceneSpec | null, trouble: Trouble | null) {
    const {hasControl, role, leases} = this.connection;
    const atRest = !trouble && !!spec?.simulated && !spec.replay &&
        (spec.results !== undefined || (!!state && kAtRest.includes(state.state)));
    const may = hasControl || (role === 'control' && leases.control === null);
    const stopped = state?.state === 'HELD' || state?.state === 'UNPOWERED';
    const listed = !!spec?.scenarios.some(({name}) => name === this.file);
    this.againButton.hidden = !(atRest && stopped && listed && !spec?.results);
    this.againButton.disabled = !may;
    this.picker.disabled = !atRest || !(hasControl || (stopped && may));
    const chosen = this.picker.selectedOptions[0]?.textContent ?? '';
    this.picker.title = !this.picker.disabled ? chosen :
        `${chosen}. To change it, take control and end or stop the run.`;
  }

  private showCommands(state: State | null, spec: SceneSpec | null, over: boolean) {
    const {hasControl, role} = this.connection;
    for (const {command, states} of kCommands) {
      const possible = !!state && states.includes(state.state) && hasControl && !!spec?.simulated;
      const button = this.commands.get(command)!;
      if (!possible && document.activeElement === button) this.commandHadFocus = true;
      button.disabled = !possible;
      // A disabled button loses the focus. For keyboard users, the focus therefore moves to the
      // next enabled button.
      if (possible && this.commandHadFocus) {
        this.commandHadFocus = false;
        if (document.activeElement === document.body) button.focus({preventScroll: true});
      }
    }
    setText(this.commandHint,
            over ? '' :
            !spec?.simulated ? 'Real arms: align, start and reset at the console (hold the enabling key).' :
            hasControl ? '' :
            role === 'control' ? 'Take control to use these buttons.' :
                                 'This page can only view and stop.');
  }

  private showLeases(spec: SceneSpec | null) {
    const {leases, client, role, phase} = this.connection;
    const allowed = {
      control: role === 'control',
      operator: role !== 'look' && spec?.operator === 'browser' && !this.connection.isExperimenter,
    };
    for (const what of ['control', 'operator'] as const) {
      const holder = leases[what];
      const mine = holder !== null && holder === client;
      setText(this.leaseTexts.get(what)!,
              mine ? 'this page' : holder === null ? 'no one' : `client ${holder}`);
      const button = this.leaseButtons.get(what)!;
      setText(button, mine ? 'Release' : 'Take');
      setAttribute(button, 'aria-label', `${mine ? 'Release' : 'Take'} ${what}`);
      button.disabled = phase !== 'open' || !allowed[what] || (holder !== null && !mine);
    }
    this.handsHint.hidden = !(this.connection.hasOperator && allowed.operator);
    const others = leases.clients === 1 ? '1 page' : `${leases.clients} pages`;
    setText(this.people, phase === 'open' ?
      `${others}. This is client ${client} (${role}).` : '');
  }

  private toggleLease(what: 'control' | 'operator') {
    const mine = this.connection.leases[what] === this.connection.client;
    this.connection.send({type: 'lease', what, take: !mine});
  }

  private pickScenario() {
    this.picker.disabled = true;
    this.choose(this.picker.value);
  }

  // The server ends the run of this scenario and restarts with the chosen one. If the scenario is a
  // different one, the page is then reloaded.
  choose(scenario: string) {
    this.againButton.disabled = true;
    if (!this.connection.hasControl) this.connection.send({type: 'lease', what: 'control', take: true});
    this.connection.send({type: 'scenario', name: scenario});
  }

  private showLedger() {
    for (const step of kSteps) {
      const figures = this.latency.figures(step);
      const digits = step === 'tick' ? 3 : 1;
      const cells = this.ledger.get(step)!;
      setText(cells.p50, figures ? figures.p50.toFixed(digits) : '–');
      setText(cells.p99, figures ? figures.p99.toFixed(digits) : '–');
    }
    const whole = this.latency.figures('tick → drawn');
    setText(this.latencyText,
            whole ? `drawn after ${whole.p50.toFixed(0)} ms, p99 ${whole.p99.toFixed(0)}` : '');
    const {clock} = this.connection;
    setText(this.clockText, clock.known ?
      `Clocks synchronised to ± ${(clock.roundTripMs / 2).toFixed(2)} ms.` : '');
  }
}
