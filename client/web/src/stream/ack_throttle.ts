// SPDX-License-Identifier: Apache-2.0
// Paces the acknowledgements of frames: the server sends the next frame once the last ones are acknowledged.

const freeFrames = 4; // frames in a row without progress that are acknowledged at once
const firstDelay = 0.02; // seconds, for the next one; doubles with each
const longestDelay = 1;

/// Acknowledges frames at once while they make progress, and frames that repeat a view without changing it later and later: a server
/// that repeats itself without end takes neither the page's time nor its own.
export class AckThrottle {
  private idleFrames = 0; // in a row
  private waiting: bigint[] = []; // sequences
  private timer: ReturnType<typeof setTimeout> | null = null;

  /// `send` acknowledges the frame of a view.
  constructor(private readonly send: (sequence: bigint) => void) {}

  /// Acknowledges a frame. `isIdle`: the frame has changed nothing, and announces another one.
  acknowledge(sequence: bigint, isIdle: boolean): void {
    this.waiting.push(sequence);
    this.idleFrames = isIdle ? this.idleFrames + 1 : 0;
    const doublings = this.idleFrames - freeFrames - 1;
    if (doublings < 0) this.sendWaiting();
    else this.timer ??= setTimeout(() => this.sendWaiting(), 1000 * Math.min(firstDelay * 2 ** doublings, longestDelay));
  }

  /// Sends the acknowledgements that wait, and counts frames without progress anew: another view is asked for.
  flush(): void {
    this.idleFrames = 0;
    this.sendWaiting();
  }

  /// Drops the acknowledgements that wait: the stream is over.
  stop(): void {
    this.idleFrames = 0;
    this.waiting = [];
    this.stopTimer();
  }

  private sendWaiting(): void {
    this.stopTimer();
    const { waiting } = this;
    this.waiting = [];
    for (const sequence of waiting) this.send(sequence);
  }

  private stopTimer(): void {
    if (this.timer !== null) clearTimeout(this.timer);
    this.timer = null;
  }
}
