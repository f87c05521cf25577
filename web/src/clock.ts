// Estimates the server's clock from pings. The estimate uses the quickest of the latest pings,
// because it was delayed least.

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

  // Adds a pong. The page sent the ping and received the pong at times of performance.now() [ms],
  // and the server answered at serverNs.
  add(sentMs: number, receivedMs: number, serverNs: number) {
    const offsetMs = serverNs / 1e6 - (sentMs + receivedMs) / 2;
    this.samples.push({roundTripMs: receivedMs - sentMs, offsetMs});
    if (this.samples.length > kWindow) this.samples.shift();
  }

  get known(): boolean {
    return this.samples.length > 0;
  }

  // Returns the server's clock minus the page's clock [ms], or NaN while it is unknown.
  get offsetMs(): number {
    return this.best?.offsetMs ?? NaN;
  }

  // Returns the round trip of the best ping [ms]. Half of the round trip bounds the error of the
  // offset.
  get roundTripMs(): number {
    return this.best?.roundTripMs ?? NaN;
  }

  private get best(): Sample | undefined {
    return this.samples.reduce<Sample | undefined>(
        (a, b) => (a && a.roundTripMs <= b.roundTripMs ? a : b), undefined);
  }
}
