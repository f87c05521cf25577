// The column beside the scene: state in words, stop, commands, leases, sliders, ledger.
import {Connection} from '../connection';
import {h, setAttribute, setText} from '../dom';
import {kSteps, LatencyLedger} from '../latency';
import {Command, kParameters, ParameterName, RunState, SceneSpec, State} from '../protocol';
import {kParameterWords, stateWords, stopWords} from '../words';
import {ParameterSlider} from './slider';

const kCommands: {command: Command; label: string; hint: string; states: RunState[]}[] = [
  {command: 'align', label: 'Align', hint: 'Idle', states: ['IDLE']},
  {command: 'start', label: 'Start', hint: 'Armed', states: ['ARMED']},
  {command: 'reset', label: 'Reset', hint: 'Stopped', states: ['HELD', 'UNPOWERED']},
];
const kLedgerMs = 500;

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
  private readonly commandHint = h('p', {class: 'hint', id: 'command-hint'});
  private readonly leaseButtons = new Map<'control' | 'operator', HTMLButtonElement>();
  private readonly leaseTexts = new Map<'control' | 'operator', HTMLElement>();
  private readonly people = h('p', {id: 'people', class: 'hint'});
  private readonly sliders = new Map<ParameterName, ParameterSlider>();
  private readonly sliderBox = h('div', {class: 'sliders'});
  private readonly ledger = new Map(kSteps.map(
      (step) => [step, {p50: h('td', {}, '–'), p99: h('td', {}, '–')}]));
  private readonly clockText = h('p', {class: 'hint', id: 'clock'});
  private lastLedgerMs = 0;

  constructor(private readonly connection: Connection, private readonly latency: LatencyLedger,
              stop: () => void) {
    this.stopButton = h(
        'button', {id: 'stop', class: 'stop', 'aria-keyshortcuts': 'Space Escape', onclick: stop},
        h('span', {}, 'STOP'), h('kbd', {}, 'Space or Esc'));
    this.element = h(
        'aside', {class: 'panel', 'aria-label': 'Run'},
        h('div', {class: 'pinned'}, this.stopButton, this.emergency, this.buildState()),
        h('div', {class: 'scroll', tabindex: 0, 'aria-label': 'Settings'}, this.buildCommands(),
          this.buildLeases(), h('section', {}, h('h3', {}, 'While running'), this.sliderBox),
          this.buildLedger()));
  }

  build(spec: SceneSpec) {
    this.pickerRow.hidden = spec.scenarios.length < 2;
    this.picker.replaceChildren(...spec.scenarios.map(
        ({name, title}) => h('option', {value: name, selected: title === spec.name}, title)));
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

  update(state: State | null, spec: SceneSpec | null, nowMs: number) {
    const open = this.connection.phase === 'open';
    this.showState(open ? state : null);
    this.stopButton.hidden = !open;
    this.emergency.hidden = open;
    this.showCommands(open ? state : null, spec);
    this.showLeases(spec);
    kParameters.forEach((name, i) =>
      this.sliders.get(name)?.update(state?.parameters[i], this.connection.hasControl, nowMs));
    if (nowMs - this.lastLedgerMs > kLedgerMs) {
      this.lastLedgerMs = nowMs;
      this.showLedger();
    }
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
    const row = h('div', {class: 'row', role: 'group', 'aria-label': 'Commands'});
    for (const {command, label, hint} of kCommands) {
      const button = h('button', {
        id: command, disabled: true, title: `Possible when: ${hint}`,
        onclick: () => this.connection.send({type: 'command', command}),
      }, label);
      this.commands.set(command, button);
      row.append(button);
    }
    return h('section', {}, h('h3', {}, 'Run'), row, this.commandHint, this.pickerRow);
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
             row('operator', 'Operator’s hands'), this.people);
  }

  private buildLedger(): HTMLElement {
    const rows = kSteps.map((step) => {
      const {p50, p99} = this.ledger.get(step)!;
      return h('tr', {}, h('th', {scope: 'row'}, step), p50, p99);
    });
    return h(
        'section', {}, h('h3', {}, 'Latency'),
        h('table', {id: 'latency'},
          h('thead', {}, h('tr', {}, h('th', {}, 'ms'), h('th', {scope: 'col'}, 'p50'),
                          h('th', {scope: 'col'}, 'p99'))),
          h('tbody', {}, ...rows)),
        this.clockText);
  }

  private showState(state: State | null) {
    const words = state ? stateWords(state.state) : null;
    setText(this.title, words?.title ?? 'Not connected');
    setText(this.meaning, words?.meaning ?? 'What is shown is not the present.');
    setAttribute(this.stateCard, 'data-tone', words?.tone ?? 'stopped');
    const stop = state ? stopWords(state) : null;
    setText(this.cause, stop?.cause ?? '');
    setText(this.advice, stop?.advice ?? '');
  }

  private showCommands(state: State | null, spec: SceneSpec | null) {
    const {hasControl, role} = this.connection;
    for (const {command, states} of kCommands) {
      const possible = !!state && states.includes(state.state) && hasControl && !!spec?.simulated;
      this.commands.get(command)!.disabled = !possible;
    }
    this.picker.disabled =
        !(state?.state === 'IDLE' && hasControl && !!spec?.simulated);
    this.picker.title = this.picker.disabled ? 'Another is chosen when idle, with control.' : '';
    setText(this.commandHint,
            !spec?.simulated ? 'Real arms: align, start and reset at the rig.' :
            hasControl ? '' :
            role === 'control' ? 'Take control to align, start and reset.' :
                                 'This page may look and stop.');
  }

  private showLeases(spec: SceneSpec | null) {
    const {leases, client, role, phase} = this.connection;
    const allowed = {
      control: role === 'control',
      operator: role !== 'look' && spec?.operator === 'browser',
    };
    for (const what of ['control', 'operator'] as const) {
      const holder = leases[what];
      const mine = holder !== null && holder === client;
      setText(this.leaseTexts.get(what)!,
              mine ? 'this page' : holder === null ? 'nobody' : `client ${holder}`);
      const button = this.leaseButtons.get(what)!;
      setText(button, mine ? 'Release' : 'Take');
      setAttribute(button, 'aria-label', `${mine ? 'Release' : 'Take'} ${what}`);
      button.disabled = phase !== 'open' || !allowed[what] || (holder !== null && !mine);
    }
    const others = leases.clients === 1 ? '1 page' : `${leases.clients} pages`;
    setText(this.people, phase === 'open' ?
      `${others} connected. This is client ${client} (${role}).` : '');
  }

  private toggleLease(what: 'control' | 'operator') {
    const mine = this.connection.leases[what] === this.connection.client;
    this.connection.send({type: 'lease', what, take: !mine});
  }

  // The server ends this scenario's run and comes back with the other; the page then loads anew.
  private pickScenario() {
    this.picker.disabled = true;
    this.connection.send({type: 'scenario', name: this.picker.value});
  }

  private showLedger() {
    for (const step of kSteps) {
      const figures = this.latency.figures(step);
      const digits = step === 'tick' ? 3 : 1;
      const cells = this.ledger.get(step)!;
      setText(cells.p50, figures ? figures.p50.toFixed(digits) : '–');
      setText(cells.p99, figures ? figures.p99.toFixed(digits) : '–');
    }
    const {clock} = this.connection;
    setText(this.clockText, clock.known ?
      `Clocks compared to ± ${(clock.roundTripMs / 2).toFixed(2)} ms.` : '');
  }
}
