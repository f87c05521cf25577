// Creates and connects all parts of the page.
import {Connection, isExperimentersAddress, Phase} from './connection';
import {h} from './dom';
import {Hands} from './hands';
import {KeyboardHand} from './keyboard';
import {LatencyLedger} from './latency';
import {MouseHand} from './mouse';
import {EventsCard} from './panel/events';
import {Invitation} from './panel/invitation';
import {Overlay} from './panel/overlay';
import {PairingPage} from './panel/pairing';
import {Panel} from './panel/panel';
import {PersonCard} from './panel/person';
import {Plots} from './panel/plots';
import {ResultsCard} from './panel/results';
import {save} from './panel/save';
import {PersonPlayer} from './person';
import {Shown, StatePlayer} from './player';
import {Headset, SceneSpec, scenarioOf, State, Welcome} from './protocol';
import {kViews, View} from './scene/camera';
import {Stage} from './scene/stage';
import {PathScore} from './score';
import {ThemeSwitch} from './theme';
import {Immersive} from './vr/immersive';
import {isStopped, RunWatch} from './watch';
import {kTroubles, lossWords, overWords, Trouble} from './words';

const kHeadsetSilenceMs = 1500;
const kWatchMs = 50;
const kFirstPictures = 10;
const kPageInVrMs = 150;  // time between updates of the page, because the headset needs the time

export class App {
  readonly connection: Connection;
  readonly player = new StatePlayer();
  readonly person = new PersonPlayer();
  readonly personCard = new PersonCard();
  readonly eventsCard = new EventsCard();
  readonly latency: LatencyLedger;
  readonly stage: Stage;
  readonly panel: Panel;
  readonly overlay: Overlay;
  readonly plots = new Plots();
  readonly results: ResultsCard;
  readonly invitation: Invitation;
  readonly hands: Hands;
  readonly mouse: MouseHand;
  readonly keyboard: KeyboardHand;
  readonly theme: ThemeSwitch;
  readonly immersive: Immersive;
  spec: SceneSpec | null = null;
  shown: State | null = null;  // newest state as interpolated and drawn
  private readonly pairing: PairingPage;
  private welcome: Welcome | null = null;
  private headsetMs = -Infinity;
  private pageMs = -Infinity;
  private lastSeen: State | null = null;
  private readonly score = new PathScore();
  private readonly watch = new RunWatch();
  private newestTick = 0;
  private pictures = 0;  // since the scene is complete
  private reason = '';  // reason for the connection's phase
  private shownTrouble: Trouble | null = kTroubles.closed;  // trouble as shown on the page

  constructor(root: HTMLElement) {
    this.connection = new Connection({
      phase: (phase, reason) => this.phaseChanged(phase, reason),
      welcome: (welcome) => this.welcomed(welcome),
      state: (state, receivedMs) => this.received(state, receivedMs),
      // Does not wait for the next frame, because a page in the background is rarely drawn.
      leases: () => this.invite(),
      denied: (_what, reason) => this.overlay.notify(reason),
      notice: (text) => this.overlay.warn(text),
      token: (token) => this.stage.setToken(token),
      headset: (headset) => this.headsetMoved(headset),
      person: (person, receivedMs) => this.person.add(person, receivedMs),
      fixtures: (fixtures) => this.stage.setFixtures(fixtures),
      acting: (acting) => (this.overlay.acting = acting),
      plan: (plan) => this.eventsCard.show(plan),
    }, isExperimentersAddress());
    this.latency = new LatencyLedger(this.connection.clock);
    this.hands = new Hands(this.connection);
    this.pairing = new PairingPage((pin) => this.connection.pair(pin));
    this.panel = new Panel(
        this.connection, this.latency, this.eventsCard.element, () => this.stop(),
        () => this.results.show(true));
    this.results = new ResultsCard({
      run: (scenario) => this.panel.choose(scenario),
      saveReport: () => void this.saveReport(),
    });
    this.overlay = new Overlay({
      view: (view) => this.setView(view),
      ghosts: (on) => this.stage.setGhosts(on),
      trail: (on) => this.stage.guidance.setTrailVisible(on),
      bothHands: (on) => (this.mouse.bothHands = on),
      body: (on) => (this.stage.bodyWanted = on),
      mirror: (on) => this.setMirror(on),
      theme: () => this.theme.toggle(),
      enterVr: () => void this.enterVr(),
      picture: () => void this.savePicture(),
    });
    const scene = h('section', {class: 'scene', 'aria-label': 'Scene'});
    this.addParts(root, scene);
    this.stage = new Stage(scene, (words) => this.overlay.warn(words));
    this.stage.camera.covered = () => this.personCard.covered(scene);
    this.invitation = new Invitation(this.connection, this.hands, this.stage);
    this.overlay.hud.append(this.invitation.element);
    scene.append(this.invitation.gauges, this.personCard.element, this.overlay.hud);
    this.mouse = new MouseHand(this.stage, this.hands, () => this.mayGrip);
    this.keyboard = new KeyboardHand(this.stage, this.hands, () => this.mayGrip);
    this.immersive = new Immersive(
        this.stage, this.hands, this.connection, () => this.mayGrip, () => this.stop(),
        () => this.trouble, () => this.setMirror(!this.stage.mirror.group.visible));
    // A person with a headset must not see future events.
    void Immersive.supported().then(
        (yes) => (this.overlay.vrButton.hidden = !yes || this.connection.isExperimenter));
    this.theme = new ThemeSwitch((theme) => {
      this.stage.paint(theme);
      this.plots.repaint();
      this.results.repaint();
    });
    this.stage.paint(this.theme.theme);
    this.listen();
  }

  private addParts(root: HTMLElement, scene: HTMLElement) {
    root.append(
        h('div', {class: 'viewer'}, this.overlay.bar, this.overlay.tools, scene, this.panel.element,
          this.plots.element, this.results.element),
        this.pairing.element);
  }

  private listen() {
    window.addEventListener('keydown', (event) => this.key(event), {capture: true});
    window.addEventListener('keyup', (event) => this.keyUp(event), {capture: true});
    window.setInterval(() => this.sendLatency(), 1000);
    window.setInterval(() => this.watchRun(), kWatchMs);
  }

  start(code: string | null) {
    this.connection.start(code);
    this.stage.renderer.setAnimationLoop((_nowMs, frame) => this.frame(frame));
  }

  stop() {
    if (this.connection.send({type: 'stop'})) {
      this.watch.asked();
    } else {
      const {title, emergency} = lossWords('closed', !!this.spec?.simulated);
      this.overlay.notify(`${title}. ${emergency}.`);
    }
  }

  // Returns the present problem between this page and the run, if there is such a problem.
  get trouble(): Trouble | null {
    if (this.connection.phase === 'ended') return kTroubles.ended;
    if (this.connection.phase === 'results') return kTroubles.results;
    if (this.spec?.results && this.connection.phase === 'open') return null;
    const simulated = !!this.spec?.simulated;
    if (this.connection.phase !== 'open') return lossWords('closed', simulated);
    if (this.watch.silent) return lossWords('silent', simulated);
    return this.watch.ignored ? lossWords('ignored', simulated) : null;
  }

  get mayGrip(): boolean {
    return this.connection.hasOperator && this.spec?.operator === 'browser';
  }

  // Real arms that may move stop when the person leaves the headset, because the person can no
  // longer see them.
  private get leavingStops(): boolean {
    const state = this.player.latest?.state;
    return this.spec?.simulated === false && state !== undefined && !isStopped(state) &&
        state !== 'IDLE';
  }

  setView(view: View) {
    if (!this.spec) return;
    const object = this.player.latest?.object.p ?? [0.5, 0, 0.4];
    this.stage.camera.go(view, this.spec, object);
  }

  private frame(xrFrame?: XRFrame) {
    const nowMs = performance.now();
    const news: Shown[] = [];
    const state = this.player.sample(nowMs, (shown) => news.push(shown));
    this.shown = state;
    if (state && this.spec) {
      this.stage.apply(state, this.hands.targets);
      this.showBody(nowMs);
      this.mouse.update(state);
      this.keyboard.update(state);
    }
    // If the connection is lost, the board still shows the last state, because the board must
    // report the loss.
    const seen = state ?? this.lastSeen;
    this.lastSeen = seen;
    if (xrFrame) this.immersive.update(xrFrame, this.spec, seen, nowMs);
    if (!xrFrame || nowMs - this.pageMs > kPageInVrMs) this.updatePage(state, nowMs);
    this.stage.render(nowMs);
    if (xrFrame) this.immersive.drawMirror();
    const renderedMs = performance.now();
    if (!this.stage.drawable) return;
    // Drawing the first frames takes a long time. The delays of the states that arrived meanwhile
    // are not typical of the run.
    if (!this.stage.settled || ++this.pictures <= kFirstPictures) return;
    for (const {state: s, receivedMs} of news) this.latency.add(s, receivedMs, renderedMs);
    const newest = news.at(-1)?.state;
    if (newest) this.immersive.drawnNs = newest.wallNs;
  }

  private updatePage(state: State | null, nowMs: number) {
    this.pageMs = nowMs;
    if (state && this.spec && !this.spec.results && !this.watch.silent && !this.isOver) {
      this.overlay.update(
          state, this.spec, this.stage.guidance.error(state.object.p), this.score.result);
    }
    if (state) this.plots.draw(nowMs);
    this.personCard.show(this.person.latest, this.person.silent(nowMs), nowMs, this.isOver);
    this.panel.update(this.player.latest, this.spec, nowMs, this.trouble);
    this.invite();
    this.updateResults();
    this.overlay.showView(this.stage.camera.view);
    this.overlay.showOperator(this.mayGrip);
    this.overlay.showVr(this.immersive.session !== null, this.leavingStops);
    this.watchHeadset(nowMs);
  }

  private showBody(nowMs: number) {
    const known = !this.spec?.results && !this.person.silent(nowMs);
    this.stage.applyPerson(known ? this.person.sample(nowMs) : null, this.person.latest?.parts ?? null);
  }

  private setMirror(on: boolean) {
    this.stage.mirror.group.visible = on;
    this.overlay.showMirror(on);
  }

  private invite() {
    this.invitation.update(this.isOver ? null : this.shown, this.spec, performance.now());
  }

  // Returns whether the run has announced its end.
  private get isOver(): boolean {
    return this.shownTrouble === kTroubles.ended || this.shownTrouble === kTroubles.results;
  }

  private updateResults() {
    const {phase, role, leases, client} = this.connection;
    const free = leases.control === null || leases.control === client;
    const {title, tone} = overWords(this.player.latest, '');
    this.results.update(title, tone === 'stopped', this.panel.stopText.cause,
                        role === 'control' && free, phase === 'open');
    this.panel.offerResults(!!this.spec?.results && !this.results.isShown);
  }

  private async saveReport() {
    const path = this.spec?.results?.report;
    if (!path) return;
    const answer = await fetch(path, {headers: {Authorization: `Bearer ${this.stage.token}`}});
    if (!answer.ok) return this.overlay.notify('The report could not be loaded.');
    save('report.html', await answer.blob());
  }

  private async enterVr() {
    const state = this.player.latest;
    if (!this.spec || !state) return;
    if (this.immersive.session) return this.immersive.session.end();
    try {
      await this.immersive.enter(this.spec, state);
    } catch (error) {
      this.overlay.notify(`The headset: ${(error as Error).message}`);
    }
  }

  private async savePicture() {
    const picture = await this.stage.picture();
    if (picture) save('scene.png', picture);
  }

  private received(state: State, receivedMs: number) {
    this.player.add(state, receivedMs);
    // A recording may be paused or rewound, so its states are compared by time instead of by tick.
    this.watch.heard(this.spec?.replay ? state.wallNs : state.tick, state.state);
    if (!this.spec) return;
    this.stage.warn(state);
    if (this.spec.replay && state.tick < this.newestTick) this.forget();
    this.newestTick = state.tick;
    this.plots.add(state, this.spec);
    this.stage.guidance.track(state.object.p, state.runTime);
    this.score.add(state, this.spec, this.stage.guidance.error(state.object.p));
  }

  // After a jump back, clears what was drawn for times after the new position.
  private forget() {
    this.plots.clear();
    this.stage.guidance.clear();
    this.score.clear();
    this.person.reset();
  }

  private welcomed(welcome: Welcome) {
    // If the scenario has changed, the page is reloaded, because its parts belong to the previous
    // scenario. It keeps the token.
    if (this.welcome && scenarioOf(this.welcome.scene) !== scenarioOf(welcome.scene)) {
      return location.reload();
    }
    const restarted = this.welcome !== null && this.welcome.server !== welcome.server;
    this.welcome = welcome;
    this.spec = welcome.scene;
    this.player.reset();
    this.person.reset();
    this.latency.reset();
    this.pictures = 0;
    // The plots of a run stay visible next to its results.
    if (!welcome.scene.results) {
      if (restarted) this.plots.clear();
      this.stage.guidance.clear();
      this.score.clear();
    }
    this.results.build(welcome.scene);
    this.panel.build(welcome.scene);
    this.eventsCard.clear();
    this.overlay.build(welcome.scene);
    this.personCard.build(welcome.scene);
    if (welcome.scene.notice) this.overlay.warn(welcome.scene.notice);
    this.stage.build(welcome.scene, welcome.token);
  }

  private phaseChanged(phase: Phase, reason: string) {
    if (phase === 'pairing') {
      this.pairing.show(reason, this.welcome !== null && !this.spec?.simulated);
    } else {
      this.pairing.hide();
    }
    this.reason = reason;
    this.watch.reset();
    // On a slow computer, the last states of a run arrive after the last drawn one.
    const {latest} = this.player;
    if ((phase === 'ended' || phase === 'results') && latest && this.spec) this.overlay.showTime(latest, this.spec);
    if (!['open', 'results', 'ended'].includes(phase)) {
      this.player.reset();
      this.person.reset();
    }
    // The page is updated immediately and does not wait for the next frame, because it must never
    // show a stop button that has no effect.
    this.showTrouble();
  }

  private watchRun() {
    this.watch.pass(performance.now());
    if (this.trouble !== this.shownTrouble) this.showTrouble();
  }

  private showTrouble() {
    this.shownTrouble = this.trouble;
    this.overlay.showBanner(this.banner(), this.connection.phase === 'connecting' || this.isOver);
    if (this.shownTrouble && !this.shownTrouble.mayStop) this.overlay.clear();
    this.panel.update(this.player.latest, this.spec, performance.now(), this.shownTrouble);
  }

  private banner(): string {
    switch (this.connection.phase) {
      case 'connecting': return 'Connecting …';
      case 'lost':
        return ['Connection lost.', this.reason, 'Trying again … This display is out of date.']
            .filter((words) => words !== '').join(' ');
      case 'results': return `${this.reason} Preparing the results …`;
      case 'ended': return this.reason;
      case 'open': return this.shownTrouble ? `${this.shownTrouble.title}. ${this.shownTrouble.meaning}` : '';
      default: return '';
    }
  }

  // Space and Esc stop the run regardless of the focus. Enter presses buttons. No other keys have a
  // function.
  private key(event: KeyboardEvent) {
    if (event.key === ' ' || event.key === 'Escape') {
      event.preventDefault();
      event.stopImmediatePropagation();
      if (event.repeat || this.connection.phase === 'pairing') return;
      if (this.spec?.replay) {
        this.panel.transport.toggle();
      } else {
        this.stop();
      }
      return;
    }
    const typing = event.target instanceof HTMLInputElement && event.target.type !== 'range';
    if (event.key.toLowerCase() === 'm' && !typing && !event.ctrlKey && !event.repeat) this.panel.mark();
    const view = kViews[Number(event.key) - 1];
    if (view && !typing && !event.ctrlKey && !event.altKey && !event.metaKey) this.setView(view);
  }

  // When Space is released, browsers press the button that has the focus. This handler prevents
  // that.
  private keyUp(event: KeyboardEvent) {
    if (event.key === ' ') event.preventDefault();
  }

  private headsetMoved(headset: Headset) {
    if (headset.client === this.connection.client) return;
    this.headsetMs = headset.active ? performance.now() : -Infinity;
    this.stage.camera.setHeadset(headset.active ? {p: headset.p, q: headset.q} : null);
  }

  private watchHeadset(nowMs: number) {
    const available = nowMs - this.headsetMs < kHeadsetSilenceMs;
    this.overlay.showHeadsetView(available);
    if (!available && this.stage.camera.view === 'headset') this.setView('free');
  }

  private sendLatency() {
    const medians = this.latency.takeMedians();
    if (medians) this.connection.send({type: 'latency', ...medians});
  }
}
