// Shows the elements over the scene: the title bar, the instruction, the guidance error, the tools
// and the banner.
import {h, setAttribute, setText} from '../dom';
import {SceneSpec, State} from '../protocol';
import {Score} from '../score';
import {kViews, View} from '../scene/camera';
import {gripWords, hazardWords} from '../words';

const kViewWords: Record<View, string> = {
  free: 'Free', front: 'Front', side: 'Side', top: 'Top', operator: 'Operator',
  headset: 'Headset',
};

const millimetres = (metres: number) => `${(1000 * metres).toFixed(1)} mm`;

// Returns the length of a run [s]. For a run without a planned end, this is the length of its
// script.
function lengthOf(spec: SceneSpec): number {
  const script = spec.script.map(({start, duration}) => start + duration);
  return spec.duration > 0 ? spec.duration : Math.max(...script, 1);
}

export interface OverlayActions {
  view(view: View): void;
  ghosts(on: boolean): void;
  trail(on: boolean): void;
  bothHands(on: boolean): void;
  body(on: boolean): void;
  mirror(on: boolean): void;
  theme(): void;
  enterVr(): void;
  picture(): void;
}

export class Overlay {
  readonly bar: HTMLElement;
  readonly tools: HTMLElement;
  readonly hud: HTMLElement;
  acting: string[] = [];  // what each acting event does, the newest last
  readonly banner = h('div', {class: 'banner', id: 'banner', role: 'alert', hidden: true});
  readonly vrButton: HTMLButtonElement;
  private readonly bodyButton: HTMLButtonElement;
  private readonly mirrorButton: HTMLButtonElement;
  private readonly name = h('span', {class: 'scene-name'});
  private readonly recording = h('span', {class: 'recording', id: 'recording', hidden: true},
                                 h('i', {}), 'Recording');
  private readonly time = h('span', {class: 'time', id: 'run-time'});
  private readonly mode = h('span', {class: 'tag', id: 'mode', hidden: true});
  private readonly instruction = h('div', {class: 'instruction', id: 'instruction',
                                           role: 'status', hidden: true});
  private readonly guidance = h('div', {class: 'guidance', id: 'guidance', hidden: true});
  private readonly score = h('div', {class: 'guidance', id: 'score', role: 'status', hidden: true});
  private readonly hazards = h('div', {class: 'guidance', id: 'hazards', role: 'status', hidden: true});
  // This line appears when the grip changes for the first time, because most cobots never release
  // the object.
  private readonly grip = h('div', {class: 'guidance', id: 'grip', role: 'status', hidden: true});
  private readonly progressBar = h('i', {});
  private readonly progress = h(
      'div', {class: 'progress', id: 'progress', role: 'progressbar', 'aria-label': 'Script',
              'aria-valuemin': 0, 'aria-valuemax': 100, hidden: true}, this.progressBar);
  private readonly notice = h('div', {class: 'notice', id: 'notice', role: 'status', hidden: true});
  // The warning stays until the person dismisses it.
  private readonly warning = h('div', {});
  private readonly warningBox = h(
      'div', {class: 'notice warning', id: 'warning', role: 'status', hidden: true}, this.warning,
      h('button', {class: 'small', 'aria-label': 'Close', onclick: () => this.closeWarning()}, '×'));
  private readonly viewButtons = new Map<View, HTMLButtonElement>();
  private readonly bothButton: HTMLButtonElement;
  private readonly ghostButton: HTMLButtonElement;
  private noticeTimer = 0;

  constructor(private readonly actions: OverlayActions) {
    this.vrButton = h('button', {id: 'enter-vr', hidden: true, onclick: () => actions.enterVr()},
                      'Enter VR');
    this.bar = h(
        'header', {class: 'bar'}, h('b', {class: 'brand'}, 'PREDICTOR'), this.name, this.mode,
        h('span', {class: 'spacer'}), this.recording, this.time, this.vrButton,
        h('button', {class: 'small', id: 'theme', 'aria-label': 'Dark or light', title:
                     'Dark or light', onclick: () => actions.theme()}, '◐'), this.progress);
    this.ghostButton = this.toggle('ghosts', 'Real arms', false, (on) => actions.ghosts(on));
    this.bothButton = this.toggle('both-hands', 'Both hands', false, (on) => actions.bothHands(on));
    this.bothButton.title = 'Dragging one handle moves both (or hold Ctrl)';
    this.bothButton.hidden = true;
    this.bodyButton = this.toggle('body', 'Body', true, (on) => actions.body(on));
    this.mirrorButton = this.toggle('mirror', 'Mirror', false, (on) => actions.mirror(on));
    this.mirrorButton.title = 'Shows the body from the front, beside the scene';
    this.tools = h('div', {class: 'tools', role: 'toolbar', 'aria-label': 'View'},
                   ...this.buildViews(), h('span', {class: 'gap'}), this.ghostButton,
                   this.toggle('trail', 'Trail', true, (on) => actions.trail(on)),
                   this.bodyButton, this.mirrorButton, this.bothButton, h('span', {class: 'spacer'}),
                   h('button', {class: 'small', id: 'save-picture', title: 'Save the scene as an image (PNG)',
                                onclick: () => actions.picture()}, 'Save picture'));
    this.hud = h('div', {class: 'hud'}, this.banner, this.instruction, this.guidance, this.score,
                 this.hazards, this.grip, this.notice, this.warningBox);
  }

  build(spec: SceneSpec) {
    setText(this.name, spec.name);
    this.acting = spec.acting ?? [];
    this.grip.hidden = true;
    document.title = `${spec.name} · PREDICTOR`;
    this.mode.hidden = spec.simulated && spec.mode === 'emulate';
    setText(this.mode, spec.simulated ? spec.mode : 'real arms');
    this.ghostButton.hidden = !spec.arms.left && !spec.arms.right;
    for (const button of [this.bodyButton, this.mirrorButton]) button.hidden = !spec.person?.judged;
    this.buildProgress(spec);
  }

  // This function is called when the person has switched the mirror on or off in the headset.
  showMirror(on: boolean) {
    setAttribute(this.mirrorButton, 'aria-pressed', String(on));
  }

  update(state: State, spec: SceneSpec, guidanceError: number, score: Score | null) {
    const action = spec.script[state.action];
    const text = state.state === 'RUN' ? action?.text ?? '' : '';
    setText(this.instruction, text);
    this.instruction.hidden = text === '';
    this.recording.hidden = !state.recording;
    this.showTime(state, spec);
    this.guidance.hidden = !Number.isFinite(guidanceError) || score !== null;
    setText(this.guidance, `Off the path: ${(1000 * guidanceError).toFixed(0)} mm`);
    this.score.hidden = score === null;
    if (score) {
      setText(this.score, `Off the circle on average ${millimetres(score.mean)}, ` +
          `at most ${millimetres(score.largest)}`);
    }
    const hazards = hazardWords(state, this.acting);
    this.hazards.hidden = hazards === '';
    setText(this.hazards, hazards);
    if (state.attachment > 0) this.grip.hidden = false;
    setText(this.grip, gripWords(state));
  }

  showTime({runTime}: State, spec: SceneSpec) {
    setText(this.time, spec.duration > 0 ? `${runTime.toFixed(1)} / ${spec.duration.toFixed(0)} s` :
                                           `${runTime.toFixed(1)} s`);
    const part = Math.min(runTime / lengthOf(spec), 1);
    this.progressBar.style.width = `${100 * part}%`;
    setAttribute(this.progress, 'aria-valuenow', (100 * part).toFixed(0));
  }

  // Marks the beginning of each action of the script.
  private buildProgress(spec: SceneSpec) {
    this.progress.hidden = spec.script.length === 0;
    this.progress.replaceChildren(this.progressBar, ...spec.script.map(({start, text}) => {
      const mark = h('b', {title: text});
      mark.style.left = `${Math.min((100 * start) / lengthOf(spec), 100)}%`;
      return mark;
    }));
  }

  // `calm` is true if there is no problem.
  showBanner(text: string, calm: boolean) {
    setText(this.banner, text);
    this.banner.classList.toggle('calm', calm);
    this.banner.hidden = text === '';
  }

  // Removes instructions that no longer apply.
  clear() {
    this.instruction.hidden = true;
    this.guidance.hidden = true;
    this.score.hidden = true;
    this.hazards.hidden = true;
    this.recording.hidden = true;
  }

  // Shows a message that disappears by itself.
  notify(text: string) {
    setText(this.notice, text);
    this.notice.hidden = false;
    window.clearTimeout(this.noticeTimer);
    this.noticeTimer = window.setTimeout(() => (this.notice.hidden = true), 5000);
  }

  // Shows messages that stay until they are dismissed.
  warn(text: string) {
    this.warning.append(h('p', {}, text));
    this.warningBox.hidden = false;
  }

  showView(view: View) {
    for (const [name, button] of this.viewButtons) {
      setAttribute(button, 'aria-pressed', String(name === view));
    }
  }

  showHeadsetView(available: boolean) {
    this.viewButtons.get('headset')!.hidden = !available;
  }

  showOperator(isOperator: boolean) {
    this.bothButton.hidden = !isOperator;
  }

  // `stops` states whether leaving the headset stops the real arms.
  showVr(immersive: boolean, stops: boolean) {
    setText(this.vrButton,
            !immersive ? 'Enter VR' : stops ? 'Leave VR (stops the arms)' : 'Leave VR');
  }

  get instructionText(): string {
    return this.instruction.hidden ? '' : this.instruction.textContent ?? '';
  }

  private closeWarning() {
    this.warning.textContent = '';
    this.warningBox.hidden = true;
  }

  private buildViews(): HTMLButtonElement[] {
    return kViews.map((view, i) => {
      const button = h('button', {
        class: 'small', id: `view-${view}`, 'aria-pressed': String(view === 'free'),
        title: `View: ${kViewWords[view]} (key ${i + 1})`, hidden: view === 'headset',
        onclick: () => this.actions.view(view),
      }, kViewWords[view]);
      this.viewButtons.set(view, button);
      return button;
    });
  }

  private toggle(id: string, label: string, on: boolean, changed: (on: boolean) => void) {
    const button = h('button', {class: 'small', id, 'aria-pressed': String(on)}, label);
    button.addEventListener('click', () => {
      const pressed = button.getAttribute('aria-pressed') !== 'true';
      button.setAttribute('aria-pressed', String(pressed));
      changed(pressed);
    });
    return button;
  }
}
