// Notices that the other end is gone although nothing has told so: a browser does not see the pings of a server.

import { now } from "./clock";

/// What is watched.
export interface Monitored {
  /// Bytes that were given to be sent, all told, and those of them that still wait. That some have left is a sign of life while others
  /// wait; where none do it is not: the system takes a few bytes even where they go nowhere.
  bytes(): { sent: number; waiting: number };
  /// Asks for a sign of life. May be called again before there is one.
  probe(): void;
  /// There was none.
  dead(): void;
}

const secondsBetweenChecks = 1;
const secondsForAnswer = 10; // to a probe
const lateSeconds = 5; // a timer may be late: hidden tabs have slow ones, and computers sleep

/// Probes after `idleTimeout` seconds without a sign of life. Has a timer only while it runs.
export class LivenessMonitor {
  private timer: ReturnType<typeof setInterval> | null = null;
  private heardAt = 0;
  private probedAt: number | null = null;
  private wasLate = false; // the last probe went out again because its time was up at a late look
  private checkedAt = 0;
  private left = 0; // bytes, up to the last look

  constructor(
    private readonly monitored: Monitored,
    private readonly idleTimeout: number,
  ) {}

  start(): void {
    if (this.timer !== null) return;
    this.heard();
    this.checkedAt = this.heardAt;
    const { sent, waiting } = this.monitored.bytes();
    this.left = sent - waiting;
    this.timer = setInterval(() => this.check(), 1000 * secondsBetweenChecks);
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

  private check(): void {
    const time = now();
    const isLate = time - this.checkedAt > lateSeconds;
    this.checkedAt = time;
    const { sent, waiting } = this.monitored.bytes();
    if (waiting > 0 && sent - waiting > this.left) this.heard();
    this.left = sent - waiting;
    if (this.probedAt === null) {
      if (time - this.heardAt >= this.idleTimeout) this.probe(time);
    } else if (time - this.probedAt >= secondsForAnswer) {
      // What came while this page stood still may wait behind this look.
      if (isLate && !this.wasLate) {
        this.wasLate = true;
        this.probe(time);
      } else {
        this.stop();
        this.monitored.dead();
      }
    }
  }

  private probe(time: number): void {
    this.probedAt = time;
    this.monitored.probe();
  }
}
