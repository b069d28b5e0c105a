// Decides when the server is asked for the next view.

const maxDelay = 1000; // ms that a view waits while the processor draws

/// Asks at once, but once a picture at most: the server works while the picture is drawn. Where the processor draws, both would take
/// each other's time, so that a view waits until the picture is there; but never longer than `maxDelay`, however many pictures follow
/// each other.
export class ViewPacer {
  private isDue = false;
  private hasAsked = false; // since the last picture
  private timer: ReturnType<typeof setTimeout> | undefined;

  /// `ask` asks for the view of the moment. `isDrawing`: the processor draws, and drawn() will be called.
  constructor(
    private readonly ask: () => void,
    private readonly isDrawing: () => boolean,
  ) {}

  /// What is to be seen has changed.
  request(): void {
    this.isDue = true;
    if (this.hasAsked) return; // the next picture's callback asks
    if (this.isDrawing()) this.timer ??= setTimeout(() => this.askNow(), maxDelay);
    else this.askNow();
  }

  /// The processor has drawn the picture.
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
