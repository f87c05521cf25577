// What the tests in front of the program begin with: the program, a page that looks at it, and a client
// that takes down every state.
import {after, before} from 'node:test';
import {asker, launch, open, ready, shotsWanted, waitFor} from './harness.mjs';
import {Client, kStates, lightCobot, Program} from './program.mjs';

const kSmall = {width: 900, height: 700};
const kLarge = {width: 1280, height: 720};

export class Rig {
  states = [];  // of the client, `state` in words

  // Before and after all tests of a file. Options: set (['path.to.key=value']), args; light: a cobot of
  // cylinders and spheres, else (and whenever pictures are asked for) of its meshes; viewport (not for
  // pictures); unpainted: as launch has it; page: a function that is given the page before it
  // loads anything; begun: what is called once all this is there.
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

  // Until the run is in a state.
  async reach(state) {
    await waitFor(() => this.newest.state === state, state);
  }

  // Until so many more ticks are over.
  async ticks(count) {
    const {tick} = this.newest;
    await waitFor(() => this.newest.tick >= tick + count, `${count} ticks`);
  }

  // As the client, which needs control: held still, nothing moves while a test prepares something.
  async command(name, state) {
    this.client.send({type: 'command', command: name});
    await this.reach(state);
  }
}
