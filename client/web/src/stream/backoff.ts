/// Pauses between attempts: twice as long every time, less up to half, which spreads the load of many clients that lost the same
/// server. Seconds.
export class Backoff {
  private delay: number;

  constructor(
    private readonly first: number,
    private readonly longest: number,
  ) {
    this.delay = first;
  }

  next(): number {
    const delay = this.delay * (0.5 + 0.5 * Math.random());
    this.delay = Math.min(2 * this.delay, this.longest);
    return delay;
  }

  reset(): void {
    this.delay = this.first;
  }
}
