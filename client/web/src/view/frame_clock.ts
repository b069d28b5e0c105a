// Decides when frames are drawn, and how finely: on demand only, and coarser while something moves on a slow machine.

const slowFrame = 42; // ms; while frames take longer, they are drawn more coarsely
const fastFrame = 19; // ms; while frames take less, they are drawn more finely
const quiet = 160; // ms without motion until the picture counts as still
const coarsest = 0.35; // scale
const longestGap = 1000; // ms; frames farther apart do not belong to one motion

/// Calls `draw` for the frames that invalidate() asks for.
export class FrameClock {
  private request = 0;
  private settling: ReturnType<typeof setTimeout> | undefined;
  private lastFrame = -Infinity;
  private lastMotion = -Infinity;
  private measured = 0; // ms between frames while something moves; 0: not known
  private expected = 0; // ms between frames at the scale of now
  private isMoving = false; // the last frame was part of a motion
  private scaleNow: number;
  private isStopped = false;
  private heldUntil = -Infinity;
  private isReleased = false;
  private isCoarse = false; // the last frame was coarse
  private holding: ReturnType<typeof setTimeout> | undefined;

  /// `draw` gets the time in ms and the scale of the picture, and returns whether something moves on. `isSlow`: drawing a frame takes
  /// longer than the time to the next, so that settle() is called when a frame is drawn.
  constructor(
    private readonly draw: (now: number, scale: number) => boolean,
    private readonly isSlow: boolean,
  ) {
    this.scaleNow = isSlow ? 0.5 : 1;
  }

  /// Frames a second while something moves; 0 where nothing has moved for a second.
  get framesPerSecond(): number {
    const isStale = performance.now() - this.lastMotion > longestGap;
    return this.measured > 0 && !isStale ? 1000 / this.measured : 0;
  }

  /// Asks for a frame. `isMotion`: the frame is one of several, and has to come soon rather than be fine.
  invalidate(isMotion: boolean): void {
    if (isMotion) this.lastMotion = performance.now();
    if (this.request === 0 && !this.isStopped) this.request = requestAnimationFrame((now) => this.frame(now));
  }

  /// Whether a frame that was held back has yet to be drawn.
  get isDue(): boolean {
    return this.isReleased;
  }

  /// Holds frames back for so many milliseconds, or until release().
  hold(milliseconds: number): void {
    this.heldUntil = performance.now() + milliseconds;
    clearTimeout(this.holding);
    this.holding = setTimeout(() => this.release(), milliseconds);
  }

  /// Draws the frames that hold() has held back.
  release(): void {
    clearTimeout(this.holding);
    if (this.heldUntil === -Infinity) return;
    this.heldUntil = -Infinity;
    this.isReleased = true;
    this.invalidate(false); // for the frames that were asked for meanwhile
  }

  /// Draws no frames while it is paused.
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

  /// Draws a fine frame after a coarse one, unless another frame comes soon.
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
      this.expected *= 0.7; // coarser frames will take less
    } else if (this.expected < fastFrame && this.scaleNow < 1) {
      this.scaleNow = Math.min(1, this.scaleNow * 1.02);
    }
  }
}
