// When frames are drawn, and how finely: on demand only; coarser while something moves on a machine that is too slow for it.

/// While things change, frames are drawn as coarsely as keeps them under this.
const slowFrame = 42; // ms
const fastFrame = 19;
const quiet = 160; // ms until a moving picture counts as still
const coarsest = 0.35;
const longestGap = 1000; // ms; frames farther apart do not follow each other

export class FrameClock {
  private request = 0;
  private settling: ReturnType<typeof setTimeout> | undefined;
  private lastFrame = -Infinity;
  private lastMotion = -Infinity;
  private measured = 0; // ms between frames while something moves; 0: not known
  private expected = 0; // the same as the choice of the scale takes it
  private isMoving = false; // in the last frame
  private scaleNow: number;
  private isStopped = false;
  private heldUntil = -Infinity;
  private isReleased = false;
  private isCoarse = false; // the last frame was
  private holding: ReturnType<typeof setTimeout> | undefined;

  /// `draw` gets the time, ms, and the scale of the picture; true: it wants another frame, and moves. `isSlow`: each takes longer
  /// than the next comes after, so that settle() has to tell when it has been drawn.
  constructor(
    private readonly draw: (now: number, scale: number) => boolean,
    private readonly isSlow: boolean,
  ) {
    this.scaleNow = isSlow ? 0.5 : 1;
  }

  /// Of the frames that followed each other; 0 where nothing has moved for a second.
  get framesPerSecond(): number {
    const isStale = performance.now() - this.lastMotion > longestGap;
    return this.measured > 0 && !isStale ? 1000 / this.measured : 0;
  }

  /// Has a frame drawn. `isMotion`: one of several, which has to come soon rather than be fine.
  invalidate(isMotion: boolean): void {
    if (isMotion) this.lastMotion = performance.now();
    if (this.request === 0 && !this.isStopped) this.request = requestAnimationFrame((now) => this.frame(now));
  }

  /// What was held back has yet to be drawn.
  get isDue(): boolean {
    return this.isReleased;
  }

  /// No frames for so long, or until release().
  hold(milliseconds: number): void {
    this.heldUntil = performance.now() + milliseconds;
    clearTimeout(this.holding);
    this.holding = setTimeout(() => this.release(), milliseconds);
  }

  release(): void {
    clearTimeout(this.holding);
    if (this.heldUntil === -Infinity) return;
    this.heldUntil = -Infinity;
    this.isReleased = true;
    this.invalidate(false); // for those that were asked for meanwhile
  }

  /// No frames until it is resumed.
  pause(isPaused: boolean): void {
    this.isStopped = isPaused;
    cancelAnimationFrame(this.request);
    this.request = 0;
    clearTimeout(this.settling);
    if (!isPaused) this.invalidate(false);
  }

  private frame(now: number): void {
    this.request = 0;
    if (performance.now() < this.heldUntil) return;
    this.isReleased = false;
    const gap = now - this.lastFrame;
    this.lastFrame = now;
    const isMoving = performance.now() - this.lastMotion < quiet;
    if (gap >= longestGap) this.measured = 0;
    else if (isMoving && this.isMoving) this.measure(gap);
    this.isMoving = isMoving;
    clearTimeout(this.settling);
    if (this.draw(now, isMoving ? this.scaleNow : 1)) this.invalidate(true);
    this.isCoarse = isMoving && this.scaleNow < 1;
    if (!this.isSlow) this.settle();
  }

  /// A fine frame follows a coarse one, unless another comes soon.
  settle(): void {
    if (!this.isCoarse || this.isStopped) return;
    clearTimeout(this.settling);
    this.settling = setTimeout(() => this.invalidate(false), quiet + 20);
  }

  private measure(gap: number): void {
    const smooth = (before: number): number => (before > 0 ? 0.8 * before + 0.2 * gap : gap);
    this.measured = smooth(this.measured);
    this.expected = smooth(this.expected);
    if (this.expected > slowFrame && this.scaleNow > coarsest) {
      this.scaleNow = Math.max(coarsest, this.scaleNow * 0.8);
      this.expected *= 0.7; // that coarser frames will take
    } else if (this.expected < fastFrame && this.scaleNow < 1) {
      this.scaleNow = Math.min(1, this.scaleNow * 1.02);
    }
  }
}
