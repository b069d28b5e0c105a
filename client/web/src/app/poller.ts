// SPDX-License-Identifier: Apache-2.0
// Repeats a job.

/// Runs a job again and again, one run at a time. The job returns the seconds until its next run, or null where there is none. A run
/// may use what it finds only while `isCurrent()`: else the poller was started anew, or stopped, meanwhile.
export class Poller {
  private run = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly job: (isCurrent: () => boolean) => Promise<number | null>) {}

  /// Runs the job at once. A run under way is not current any more. The job must not reject.
  async start(job = this.job): Promise<void> {
    this.stop();
    const { run } = this;
    const seconds = await job(() => run === this.run);
    if (run === this.run && seconds !== null) this.timer = setTimeout(() => void this.start(), 1000 * seconds);
  }

  /// Lets no run follow. A run under way is not current any more.
  stop(): void {
    this.run += 1;
    clearTimeout(this.timer);
  }
}
