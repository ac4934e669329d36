// Rates and ages of streams. Pure: the time is passed in [ms].

/** Events per second over the last 2 s. */
export class RateMeter {
  private times: number[] = [];

  count(now: number): void {
    this.times.push(now);
    if (this.times.length > 400) this.times = this.times.slice(-200);
  }

  hz(now: number): number {
    const recent = this.times.filter(t => now - t <= 2000);
    this.times = recent;
    return recent.length < 2 ? 0 : recent.length / Math.max(0.5, Math.min(2, (now - recent[0]!) / 1000));
  }
}

/** How old what comes is beyond the best of the last 30 s: clocks of source and page need not agree (a simulation begins at 0). */
export class AgeMeter {
  ageMs = 0;
  roundTripMs = 0;
  private differences: {t: number; value: number}[] = [];
  private roundTrips: number[] = [];
  private lastStampUs: number | null = null;
  /** When the last stamp is due [ms], in a clock of this source's speed. */
  private due = 0;

  addRoundTrip(ms: number): void {
    this.roundTrips.push(ms);
    if (this.roundTrips.length > 15) this.roundTrips.shift();
    this.roundTripMs = Math.min(...this.roundTrips);
  }

  /** The source's time stood still, or its speed was changed: what was the best before says nothing now. */
  restart(): void {
    this.differences = [];
    this.ageMs = 0;
  }

  /** @param speed source seconds per second; 1 for real clocks. */
  add(now: number, stampUs: number, speed: number): void {
    if (this.lastStampUs !== null && stampUs < this.lastStampUs) this.restart();
    this.due += (stampUs - (this.lastStampUs ?? stampUs)) / 1000 / speed;
    this.lastStampUs = stampUs;
    // A speed that is measured is never exact: a long window would add its error up.
    const window = speed === 1 ? 30_000 : 3000, value = now - this.due;
    this.differences.push({t: now, value});
    if (this.differences.length % 64 === 0 || now - this.differences[0]!.t > window + 1000) this.differences = this.differences.filter(d => now - d.t <= window);
    let best = Infinity;
    for (const d of this.differences) best = Math.min(best, d.value);
    this.ageMs = value - best + this.roundTripMs / 2;
  }
}
