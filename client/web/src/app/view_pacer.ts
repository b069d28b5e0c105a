// SPDX-License-Identifier: Apache-2.0
// Decides when the server is asked for the next view.

const maxDelay = 1000; // ms that a view waits while the processor draws

/// Asks for a view at once, but once a picture at most: the server works while the picture is drawn. Where the processor draws, server
/// and picture would take each other's time: the view waits until the picture is there, but no longer than `maxDelay`, because pictures
/// may follow each other without a pause.
export class ViewPacer {
  private isDue = false;
  private hasAsked = false; // since the last picture
  private timer: ReturnType<typeof setTimeout> | undefined;

  /// `ask` asks for the view of the moment. `isDrawing`: the processor draws, and drawn() will be called.
  constructor(
    private readonly ask: () => void,
    private readonly isDrawing: () => boolean,
  ) {}

  /// Asks for a view as soon as possible: camera or settings have changed.
  request(): void {
    this.isDue = true;
    if (this.hasAsked) return; // the next picture's callback asks
    if (this.isDrawing()) this.timer ??= setTimeout(() => this.askNow(), maxDelay);
    else this.askNow();
  }

  /// Whether a view has still to be asked for.
  get isWaiting(): boolean {
    return this.isDue;
  }

  /// Notes that the processor has drawn.
  drawn(): void {
    if (this.isDue) this.request();
  }

  private askNow(): void {
    clearTimeout(this.timer);
    this.timer = undefined;
    this.isDue = false;
    this.hasAsked = true;
    requestAnimationFrame(() => {
      this.hasAsked = false;
      if (this.isDue) this.request();
    });
    this.ask();
  }
}
