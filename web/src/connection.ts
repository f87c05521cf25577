// Maintains the WebSocket connection to the server: admission, reconnection, heartbeat and clock.
import {ServerClock} from './clock';
import {
  Credential, EventPlan, FixtureSpec, Headset, kSubprotocol, Leases, PageMessage, PersonState, Role,
  ServerMessage, State, StateDecoder, Welcome,
} from './protocol';

export type Phase =
  | 'pairing'     // has neither code nor token, so the person types the six digits
  | 'connecting'  // before the first welcome
  | 'open'        // admitted
  | 'lost'        // was admitted; tries again
  | 'results'     // the run has ended; tries again until the server with its results is available
  | 'ended';      // the program has ended: no further attempts

const kTokenKey = 'predictor.token';
const kSilenceMs = 2500;  // pongs arrive every second: after this time the connection is considered lost
const kFirstRetryMs = 250;
const kLastRetryMs = 4000;
const kResultsMs = 90_000;       // maximum wait for the results
const kResultsRetryMs = 300;
const kTryAgain = 1013;  // close code: the server is full, but the page's credential stays valid
const kQuickPings = 6;  // sent at the beginning, to get a first offset within a second

export interface ConnectionEvents {
  phase(phase: Phase, reason: string): void;
  welcome(welcome: Welcome): void;
  state(state: State, receivedMs: number): void;
  leases(leases: Leases): void;
  denied(what: string, reason: string): void;
  notice(text: string): void;
  token(token: string): void;  // the previous token is no longer valid
  headset(headset: Headset): void;
  person(person: PersonState, receivedMs: number): void;
  fixtures(fixtures: FixtureSpec[]): void;
  acting(acting: string[]): void;
  plan(plan: EventPlan): void;
}

export class Connection {
  readonly clock = new ServerClock();
  phase: Phase = 'connecting';
  client = 0;
  role: Role = 'look';
  leases: Leases = {control: null, operator: null, clients: 0};
  features: string[] = [];
  counters = {connects: 0, states: 0, bytes: 0, sent: 0, denied: 0, reconnects: 0, handMessages: 0};

  private socket: WebSocket | null = null;
  private decoder: StateDecoder | null = null;
  private credential: Credential | null = null;  // credential for the next attempt
  private retryMs = kFirstRetryMs;
  private retryTimer = 0;
  private lastHeardMs = 0;
  private refusal = '';  // the server's answer to a refused hello; the connection then ends
  private farewell = '';  // how the run ended; the connection then ends
  private resultsFollow = false;
  private resultsSinceMs = 0;
  private pings = 0;

  // `isExperimenter` states whether the page requests future events.
  constructor(private readonly events: ConnectionEvents, readonly isExperimenter = false) {
    window.setInterval(() => this.everySecond(), 1000);
    window.setInterval(() => this.quickPing(), 120);
  }

  // Connects with the code in the URL, or otherwise with this tab's token. If there is neither a
  // code nor a token, the page asks for the six digits. An admitted page stays admitted, regardless
  // of the address that is opened in this tab.
  start(code: string | null) {
    if (this.phase === 'open') return;
    const token = sessionStorage.getItem(kTokenKey);
    if (code) {
      this.connect({code});
    } else if (token) {
      this.connect({token});
    } else {
      this.enter('pairing', '');
    }
  }

  // Connects with the six digits that a person typed.
  pair(pin: string) {
    this.connect({pin});
  }

  // Returns false if there is no connection. Messages that cannot be sent are never stored for
  // later.
  send(message: PageMessage): boolean {
    if (this.phase !== 'open' || this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    this.counters.sent++;
    if (message.type === 'hand') this.counters.handMessages++;
    return true;
  }

  get hasControl(): boolean {
    return this.phase === 'open' && this.leases.control === this.client;
  }

  get hasOperator(): boolean {
    return this.phase === 'open' && this.leases.operator === this.client;
  }

  private connect(credential: Credential) {
    window.clearTimeout(this.retryTimer);
    this.drop();
    this.credential = credential;
    this.refusal = '';
    this.farewell = '';
    if (this.phase !== 'lost' && this.phase !== 'results') this.enter('connecting', '');
    this.counters.connects++;
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    const socket = new WebSocket(`${scheme}://${location.host}/ws`, kSubprotocol);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    this.lastHeardMs = performance.now();
    socket.onopen = () => socket.send(JSON.stringify({type: 'hello', ...credential}));
    socket.onmessage = (event) => {
      if (socket === this.socket) this.receive(event.data);
    };
    socket.onclose = (event) => {
      if (socket === this.socket) this.closed(event.reason, event.code);
    };
  }

  private drop() {
    const socket = this.socket;
    this.socket = null;
    if (socket && socket.readyState <= WebSocket.OPEN) socket.close();
  }

  private receive(data: ArrayBuffer | string) {
    const nowMs = performance.now();
    this.lastHeardMs = nowMs;
    this.counters.bytes += typeof data === 'string' ? data.length : data.byteLength;
    if (typeof data !== 'string') {
      if (!this.decoder) return;
      this.counters.states++;
      this.events.state(this.decoder.decode(data), nowMs);
      return;
    }
    const message = JSON.parse(data) as ServerMessage;
    switch (message.type) {
      case 'welcome': return this.admitted(message);
      case 'refused':
        this.refusal = message.reason;
        return;
      case 'leases':
        this.leases = message;
        return this.events.leases(message);
      case 'pong': return this.clock.add(message.page_ms, nowMs, message.server_ns);
      case 'denied':
        this.counters.denied++;
        return this.events.denied(message.what, message.reason);
      case 'ended':
        this.farewell = message.text;
        this.resultsFollow = message.results_follow ?? false;
        return;
      case 'notice': return this.events.notice(message.text);
      case 'token':
        this.keep(message.token);
        return this.events.token(message.token);
      case 'headset': return this.events.headset(message);
      case 'person': return this.events.person(message, nowMs);
      case 'fixtures': return this.events.fixtures(message.fixtures);
      case 'acting': return this.events.acting(message.acting);
      case 'events': return this.events.plan(message);
    }
  }

  private admitted(welcome: Welcome) {
    if (this.phase === 'lost') this.counters.reconnects++;
    this.keep(welcome.token);
    this.decoder = new StateDecoder(welcome.frame);
    this.client = welcome.client;
    this.role = welcome.role;
    this.leases = welcome.leases;
    this.features = welcome.features ?? [];
    this.retryMs = kFirstRetryMs;
    this.clock.reset();
    this.pings = 0;
    this.events.welcome(welcome);
    this.enter('open', '');
    // If the run has ended, or if this is a recording, there are no future events.
    const {results, replay} = welcome.scene;
    if (this.isExperimenter && !results && !replay) this.send({type: 'experimenter'});
    this.quickPing();
  }

  private keep(token: string) {
    sessionStorage.setItem(kTokenKey, token);
    this.credential = {token};
  }

  private closed(reason: string, code = 0) {
    this.socket = null;
    this.leases = {control: null, operator: null, clients: 0};
    const token = sessionStorage.getItem(kTokenKey);
    // If the code was already used, the token may still be valid.
    if (this.refusal && code !== kTryAgain && token && this.credential && 'code' in this.credential) {
      return this.connect({token});
    }
    if (this.refusal && code !== kTryAgain) {
      sessionStorage.removeItem(kTokenKey);
      return this.enter('pairing', this.refusal);
    }
    const credential = this.credential;
    if (this.phase === 'results' || (this.farewell && this.resultsFollow)) return this.awaitResults(credential!);
    if (this.farewell) return this.enter('ended', this.farewell);
    if (!credential || 'pin' in credential) {
      return this.enter('pairing', reason || 'The server did not answer.');
    }
    this.enter('lost', reason);
    const waitMs = this.retryMs * (0.8 + 0.4 * Math.random());
    this.retryMs = Math.min(this.retryMs * 1.7, kLastRetryMs);
    this.retryTimer = window.setTimeout(() => this.connect(credential), waitMs);
  }

  // Waits for the new server, which replaces the server that announced the end of the run.
  private awaitResults(credential: Credential) {
    const nowMs = performance.now();
    if (this.phase !== 'results') {
      this.resultsSinceMs = nowMs;
      this.enter('results', this.farewell);
    }
    if (nowMs - this.resultsSinceMs > kResultsMs) return this.enter('ended', 'The program has ended.');
    this.retryTimer = window.setTimeout(() => this.connect(credential), kResultsRetryMs);
  }

  private everySecond() {
    if (!this.socket) return;
    if (performance.now() - this.lastHeardMs > kSilenceMs) {
      this.drop();
      this.closed('The server does not respond.');
      return;
    }
    this.send({type: 'heartbeat'});
    this.ping();
  }

  private quickPing() {
    if (this.phase === 'open' && this.pings < kQuickPings) this.ping();
  }

  private ping() {
    this.pings++;
    this.send({type: 'ping', page_ms: performance.now()});
  }

  private enter(phase: Phase, reason: string) {
    this.phase = phase;
    this.events.phase(phase, reason);
  }
}

// Returns the pairing code of the page's address and removes it from the address, so that bookmarks and
// screenshots do not contain it.
export function takeCodeFromAddress(): string | null {
  const code = new URLSearchParams(location.hash.slice(1)).get('code');
  if (location.hash) history.replaceState(null, '', location.pathname + location.search);
  return code;
}

// Returns whether the page was opened at the experimenter's address. The subject must not see this page.
export function isExperimentersAddress(): boolean {
  return location.pathname === '/experimenter';
}
