// SPDX-License-Identifier: Apache-2.0
// Notices that a server is gone although the connection seems open: browsers hide a server's pings from pages.

import { now } from "./clock";

/// The connection that is monitored.
export interface Monitored {
  /// Returns the bytes that were given to be sent so far, and those among them that still wait. Bytes that leave while others wait are a
  /// sign of life. Bytes that leave while none wait are no sign: the system takes a few even where they go nowhere.
  bytes(): { sent: number; waiting: number };
  /// Asks the server for a sign of life. May be called again before there is one.
  probe(): void;
  /// Gives the connection up: a probe was not answered.
  dead(): void;
}

const secondsBetweenChecks = 1;
const secondsForAnswer = 10; // that a probe may take
const lateSeconds = 5; // a check so late says that the page stood still: hidden tabs have slow timers, and computers sleep

/// Probes a connection after `idleTimeout` seconds without a sign of life, and gives it up where the probe is not answered. Has a timer
/// only between start() and stop().
export class LivenessMonitor {
  private timer: ReturnType<typeof setInterval> | null = null;
  private heardAt = 0;
  private probedAt: number | null = null;
  private wasLate = false; // the probe was repeated because its time was up at a late check
  private checkedAt = 0;
  private left = 0; // bytes that had left at the last check

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

  /// Notes a sign of life.
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
      // Answers that came while the page stood still may wait behind this check: probe once more.
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
