// Invites a visitor to take the virtual handles, and shows at each handle how hard the visitor
// pulls.
import {Connection} from '../connection';
import {h, setText} from '../dom';
import {Hands} from '../hands';
import {kSides, SceneSpec, Side, State} from '../protocol';
import {presentThresholds, Stage} from '../scene/stage';
import {hex, kMeaning} from '../theme';
import {level} from '../words';

const kGaugeStaysMs = 1200;  // after the handle was released

export class Invitation {
  readonly element: HTMLElement;  // element in the scene
  readonly gauges: HTMLElement;
  private readonly words = h('span', {});
  private readonly button = h('button', {class: 'primary', id: 'take-hands', onclick: () => this.take()},
                              'Take the hands');
  private readonly bySide = new Map<Side, Gauge>();
  private dragged = false;  // since the hands were taken

  constructor(private readonly connection: Connection, private readonly hands: Hands,
              private readonly stage: Stage) {
    this.element = h('div', {class: 'invitation', id: 'invitation', role: 'status', hidden: true},
                     this.button, this.words);
    for (const side of kSides) this.bySide.set(side, new Gauge(side));
    this.gauges = h('div', {class: 'gauges'}, ...[...this.bySide.values()].map(({element}) => element));
  }

  // Returns whether the hands are free and no other page could take them.
  offered(spec: SceneSpec | null): boolean {
    const {phase, role, leases} = this.connection;
    return phase === 'open' && spec?.operator === 'browser' && !spec.replay && !spec.results &&
        role !== 'look' && leases.operator === null && leases.clients === 1;
  }

  update(state: State | null, spec: SceneSpec | null, nowMs: number) {
    const running = state?.state === 'RUN';
    const offered = running && this.offered(spec);
    const mine = running && this.connection.hasOperator && spec?.operator === 'browser';
    if (this.hands.holding) this.dragged = true;
    if (!mine) this.dragged = false;
    const inviting = mine && !this.dragged;
    this.element.hidden = !offered && !inviting;
    this.button.hidden = !offered;
    setText(this.words, offered ? 'then drag a ring.' :
      'Drag a ring. Shift moves it up and down, Ctrl moves both, the wheel turns it.');
    for (const side of kSides) {
      this.stage.handles[side].invite(inviting && !!state?.hands[side].present, nowMs);
      if (state && spec) this.gauge(side, state, spec, nowMs);
    }
  }

  private take() {
    const {role, leases} = this.connection;
    this.connection.send({type: 'lease', what: 'operator', take: true});
    // The page that holds the hands also ends the run, unless another page has control.
    if (role === 'control' && leases.control === null) {
      this.connection.send({type: 'lease', what: 'control', take: true});
    }
    this.stage.renderer.domElement.focus();
  }

  private gauge(side: Side, state: State, spec: SceneSpec, nowMs: number) {
    const gauge = this.bySide.get(side)!;
    if (this.hands.targets[side]) gauge.heldMs = nowMs;
    gauge.element.hidden = nowMs - gauge.heldMs > kGaugeStaysMs;
    if (gauge.element.hidden) return;
    const {wrench, virtual} = state.hands[side];
    const box = this.gauges.getBoundingClientRect();
    const at = this.stage.project(virtual.p);
    gauge.show(Math.hypot(wrench[0], wrench[1], wrench[2]), presentThresholds(spec, state).force,
               at.x - box.left, at.y - box.top);
  }
}

class Gauge {
  heldMs = -Infinity;
  private readonly text = h('span', {});
  private readonly bar = h('i', {});
  readonly element: HTMLElement;

  constructor(side: Side) {
    this.element = h('div', {class: 'gauge', id: `gauge-${side}`, hidden: true}, this.text,
                     h('div', {class: 'gauge-bar'}, this.bar));
  }

  // `force` and `limit` are in [N]. `x` and `y` are the position of the handle in the scene [px].
  show(force: number, limit: number, x: number, y: number) {
    setText(this.text, `${force.toFixed(0)} N of ${limit.toFixed(0)} N`);
    this.bar.style.width = `${100 * Math.min(force / limit, 1)}%`;
    this.bar.style.background = hex(kMeaning[level(force, limit)]);
    this.element.style.transform = `translate(${x.toFixed(0)}px, ${y.toFixed(0)}px)`;
  }
}
