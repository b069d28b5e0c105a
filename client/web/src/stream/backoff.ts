// SPDX-License-Identifier: Apache-2.0
/// Gives the pauses between attempts, in seconds: each twice as long as the one before, up to `longest`. A random part of up to half is
/// taken off, which spreads the load of many clients that have lost the same server.
export class Backoff {
  private delay: number;

  constructor(
    private readonly first: number,
    private readonly longest: number,
  ) {
    this.delay = first;
  }

  /// Returns the next pause.
  next(): number {
    const delay = this.delay * (0.5 + 0.5 * Math.random());
    this.delay = Math.min(2 * this.delay, this.longest);
    return delay;
  }

  /// Begins with the first pause again.
  reset(): void {
    this.delay = this.first;
  }
}
