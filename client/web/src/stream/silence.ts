// Notices that the other end is gone although nothing has told so: a browser does not see the pings of a server.

import { now } from "./clock";

/// What is watched.
export interface Watched {
  /// Bytes that were given to be sent, all told, and those of them that still wait. That some have left is a sign of life while others
  /// wait; where none do it is not: the system takes a few bytes even where they go nowhere.
  bytes(): { sent: number; waiting: number };
  /// Asks for a sign of life. May be called again before there is one.
  probe(): void;
  /// There was none.
  dead(): void;
}

const secondsBetweenLooks = 1;
const secondsForAnswer = 10; // to a probe
const lateSeconds = 5; // a timer may be late: hidden tabs have slow ones, and computers sleep

/// Probes after `patience` seconds without a sign of life. Has a timer only while it runs.
export class SilenceWatch {
  private timer: ReturnType<typeof setInterval> | null = null;
  private heardAt = 0;
  private probedAt: number | null = null;
  private wasLate = false; // the last probe went out again because its time was up at a late look
  private lookedAt = 0;
  private left = 0; // bytes, up to the last look

  constructor(
    private readonly watched: Watched,
    private readonly patience: number,
  ) {}

  start(): void {
    if (this.timer !== null) return;
    this.heard();
    this.lookedAt = this.heardAt;
    const { sent, waiting } = this.watched.bytes();
    this.left = sent - waiting;
    this.timer = setInterval(() => this.look(), 1000 * secondsBetweenLooks);
  }

  stop(): void {
    if (this.timer !== null) clearInterval(this.timer);
    this.timer = null;
  }

  /// There was a sign of life.
  heard(): void {
    this.heardAt = now();
    this.probedAt = null;
    this.wasLate = false;
  }

  private look(): void {
    const time = now();
    const isLate = time - this.lookedAt > lateSeconds;
    this.lookedAt = time;
    const { sent, waiting } = this.watched.bytes();
    if (waiting > 0 && sent - waiting > this.left) this.heard();
    this.left = sent - waiting;
    if (this.probedAt === null) {
      if (time - this.heardAt >= this.patience) this.probe(time);
    } else if (time - this.probedAt >= secondsForAnswer) {
      // What came while this page stood still may wait behind this look.
      if (isLate && !this.wasLate) {
        this.wasLate = true;
        this.probe(time);
      } else {
        this.stop();
        this.watched.dead();
      }
    }
  }

  private probe(time: number): void {
    this.probedAt = time;
    this.watched.probe();
  }
}
