// A job that is done again and again.

/// One run at a time, and one timer. The job returns the seconds until its next run, null: there is none. What it finds counts only
/// while `isCurrent()`: else it was started anew, or stopped, meanwhile.
export class Poller {
  private run = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly job: (isCurrent: () => boolean) => Promise<number | null>) {}

  /// At once, in the place of the run under way. The job must not reject.
  async start(job = this.job): Promise<void> {
    this.stop();
    const { run } = this;
    const seconds = await job(() => run === this.run);
    if (run === this.run && seconds !== null) this.timer = setTimeout(() => void this.start(), 1000 * seconds);
  }

  stop(): void {
    this.run += 1;
    clearTimeout(this.timer);
  }
}
