// Shows one parameter that may change during a run. The server changes the parameter gradually, and
// the mark shows its present value.
import {h, setAttribute, setText} from '../dom';
import {ParameterName, ParameterSpec} from '../protocol';

const kSendEveryMs = 100;
const kHandsOffMs = 1500;  // after this time without input, the slider follows the run again

interface Words {
  label: string;
  unit: string;
  digits: number;
}

export class ParameterSlider {
  readonly element: HTMLElement;
  private readonly input: HTMLInputElement;
  private readonly present: HTMLElement;
  private readonly mark: HTMLElement;
  private touchedMs = -Infinity;
  private sentMs = -Infinity;
  private timer = 0;

  constructor(name: ParameterName, private readonly words: Words,
              private readonly spec: ParameterSpec, private readonly send: (v: number) => void) {
    const id = `parameter-${name}`;
    this.present = h('output', {for: id});
    this.mark = h('span', {class: 'mark', 'aria-hidden': 'true'});
    this.input = h('input', {
      id, type: 'range', min: spec.min, max: spec.max, step: (spec.max - spec.min) / 100,
      value: spec.value, oninput: () => this.changed(),
    });
    this.element = h('div', {class: 'slider'},
                     h('label', {for: id}, words.label), this.present,
                     h('div', {class: 'track'}, this.input, this.mark));
  }

  update(present: number | undefined, enabled: boolean, nowMs: number) {
    this.input.disabled = !enabled;
    if (present === undefined || !Number.isFinite(present)) return;
    setText(this.present, this.text(present));
    const part = (present - this.spec.min) / (this.spec.max - this.spec.min || 1);
    this.mark.style.setProperty('--part', String(Math.min(Math.max(part, 0), 1)));
    if (nowMs - this.touchedMs > kHandsOffMs) this.input.value = String(present);
    setAttribute(this.input, 'aria-valuetext', this.text(Number(this.input.value)));
  }

  private text(value: number): string {
    return `${value.toFixed(this.words.digits)} ${this.words.unit}`;
  }

  // Sends at most ten values per second while the person drags the slider, and always sends the
  // last value.
  private changed() {
    const nowMs = performance.now();
    this.touchedMs = nowMs;
    window.clearTimeout(this.timer);
    const wait = this.sentMs + kSendEveryMs - nowMs;
    if (wait > 0) {
      this.timer = window.setTimeout(() => this.changed(), wait);
      return;
    }
    this.sentMs = nowMs;
    this.send(Number(this.input.value));
  }
}
