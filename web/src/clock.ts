// Estimates the server's clock by pings. Of the latest ones, the quickest is used, because it was delayed
// least.

interface Sample {
  roundTripMs: number;
  offsetMs: number;
}

const kWindow = 30;

export class ServerClock {
  private samples: Sample[] = [];

  reset() {
    this.samples = [];
  }

  // Adds a pong: sent and received by performance.now() [ms], answered at serverNs.
  add(sentMs: number, receivedMs: number, serverNs: number) {
    const offsetMs = serverNs / 1e6 - (sentMs + receivedMs) / 2;
    this.samples.push({roundTripMs: receivedMs - sentMs, offsetMs});
    if (this.samples.length > kWindow) this.samples.shift();
  }

  get known(): boolean {
    return this.samples.length > 0;
  }

  // Server's clock minus the page's clock [ms]; NaN while unknown.
  get offsetMs(): number {
    return this.best?.offsetMs ?? NaN;
  }

  // Round trip of the best ping [ms]; half of it bounds the offset's error.
  get roundTripMs(): number {
    return this.best?.roundTripMs ?? NaN;
  }

  private get best(): Sample | undefined {
    return this.samples.reduce<Sample | undefined>(
        (a, b) => (a && a.roundTripMs <= b.roundTripMs ? a : b), undefined);
  }
}
