// The setup for tests with the program: it runs the program, a page that shows it, and a client
// that stores every state.
import {after, before} from 'node:test';
import {asker, launch, open, ready, shotsWanted, waitFor} from './harness.mjs';
import {Client, kStates, lightCobot, Program} from './program.mjs';

const kSmall = {width: 900, height: 700};
const kLarge = {width: 1280, height: 720};

export class Rig {
  states = [];  // received by the client, with `state` as a word

  // Sets up the rig before all tests of a file, and ends it after them. The options are `set`
  // (['path.to.key=value']) and `args`. With `light` (the default), the cobot consists of cylinders
  // and spheres instead of its meshes. `viewport` is the size of the page. When screenshots are
  // taken, these two are ignored. For `unpainted`, see launch. `page` receives the page before it
  // loads anything. `begun` is called once everything is ready.
  constructor(scenario, options = {}) {
    this.scenario = scenario;
    this.options = options;
    before(() => this.begin());
    after(() => this.end());
  }

  async begin() {
    const {light = true, viewport = kSmall} = this.options;
    this.viewport = shotsWanted ? kLarge : viewport;
    this.settings = {
      set: [...(this.options.set ?? []), ...(light && !shotsWanted ? [lightCobot()] : [])],
      args: this.options.args ?? [],
    };
    this.browser = await launch({unpainted: this.options.unpainted});
    this.program = await Program.run(this.scenario, this.settings);
    this.page = await this.open(this.program.url, this.options.page);
    await ready(this.page);
    this.client = await Client.join(this.program.url);
    this.client.onState = (state) => this.states.push({...state, state: kStates[state.state]});
    await waitFor(() => this.newest, 'a state');
    await this.options.begun?.(this);
  }

  async end() {
    this.client?.close();
    await this.browser?.close();
    await this.program?.end();
  }

  open(url, beforehand) {
    return open(this.browser, url, {viewport: this.viewport, before: beforehand});
  }

  get newest() {
    return this.states.at(-1);
  }

  predictor = asker(() => this.page);

  // Waits until the run is in a state.
  async reach(state) {
    await waitFor(() => this.newest.state === state, state);
  }

  // Waits until `count` more ticks have passed.
  async ticks(count) {
    const {tick} = this.newest;
    await waitFor(() => this.newest.tick >= tick + count, `${count} ticks`);
  }

  // Sends a command as the client, which needs control. While it is held, nothing moves during a
  // test's preparations. Repeats a reset until it is granted, because hands must be free and
  // everything must be at rest.
  async command(name, state) {
    const ask = () => this.client.send({type: 'command', command: name});
    ask();
    const again = name === 'reset' ? setInterval(ask, 300) : undefined;
    try {
      await this.reach(state);
    } finally {
      clearInterval(again);
    }
  }
}
