// Measures the delay of each step that a sample passes from the sensor to the end of drawing. A
// page cannot know when the screen shows the picture.
import {ServerClock} from './clock';
import {kStages, State} from './protocol';

const kKept = 600;  // about ten seconds of states
export const kSteps = ['sample → tick', 'tick', 'tick → sent', 'sent → received',
                       'received → drawn', 'tick → drawn'] as const;
export type Step = (typeof kSteps)[number];

export interface Figures {
  p50: number;  // [ms]
  p99: number;  // [ms]
  count: number;
}

class Samples {
  private values: number[] = [];

  add(value: number) {
    if (!Number.isFinite(value)) return;
    this.values.push(value);
    if (this.values.length > kKept) this.values.shift();
  }

  figures(): Figures | null {
    const n = this.values.length;
    if (n === 0) return null;
    const sorted = [...this.values].sort((a, b) => a - b);
    const at = (part: number) => sorted[Math.min(Math.floor(part * n), n - 1)];
    return {p50: at(0.5), p99: at(0.99), count: n};
  }

  clear() {
    this.values = [];
  }
}

export class LatencyLedger {
  private readonly steps = new Map<Step, Samples>(kSteps.map((step) => [step, new Samples()]));
  // The times of the last second that are sent for the recording [ms]. These times are measured
  // from the start of the tick.
  private received: number[] = [];
  private rendered: number[] = [];

  constructor(private readonly clock: ServerClock) {}

  reset() {
    this.steps.forEach((samples) => samples.clear());
    this.received = [];
    this.rendered = [];
  }

  // Adds a state that arrived at receivedMs and was drawn at renderedMs (performance.now()).
  add(state: State, receivedMs: number, renderedMs: number) {
    if (!this.clock.known) return;
    const offset = this.clock.offsetMs;
    const sent = state.sentNs / 1e6;
    this.step('received → drawn', renderedMs - receivedMs);
    this.step('sent → received', receivedMs + offset - sent);
    const ages = [state.hands.left, state.hands.right].filter((h) => h.present)
                     .map((h) => h.sensorAge);
    if (ages.length > 0) this.step('sample → tick', 1000 * Math.max(...ages));
    this.step('tick', state.stageUs[kStages.indexOf('tick')] / 1000);
    if (state.wallNs === 0) return;  // virtual time: the tick has no wall-clock time
    const tick = state.wallNs / 1e6;
    this.step('tick → sent', sent - tick);
    this.step('tick → drawn', renderedMs + offset - tick);
    this.received.push(receivedMs + offset - tick);
    this.rendered.push(renderedMs + offset - tick);
  }

  figures(step: Step): Figures | null {
    return this.steps.get(step)!.figures();
  }

  // Returns the medians since the last call and clears the data, or null if there is no data.
  takeMedians(): {offset_ms: number; received_ms: number; rendered_ms: number} | null {
    if (this.rendered.length === 0 || !this.clock.known) return null;
    const middle = (values: number[]) => values.sort((a, b) => a - b)[values.length >> 1];
    const medians = {
      offset_ms: this.clock.offsetMs,
      received_ms: middle(this.received),
      rendered_ms: middle(this.rendered),
    };
    this.received = [];
    this.rendered = [];
    return medians;
  }

  private step(step: Step, valueMs: number) {
    this.steps.get(step)!.add(valueMs);
  }
}
