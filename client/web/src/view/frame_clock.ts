// SPDX-License-Identifier: Apache-2.0
// Decides when frames are drawn, and how finely: on demand only, and on a slow machine with fewer pixels and fewer points while something
// moves.

const slowFrame = 42; // ms; while frames take longer, they are drawn more coarsely
const fastFrame = 19; // ms; while frames take less, they are drawn more finely
const quiet = 160; // ms without motion until the picture counts as still
const coarsest = 0.35; // scale
const coarse = 0.5; // scale below which points are given up rather than pixels
const fewest = 4000; // points
const fewAtFirst = 20_000; // points of a moving picture where the processor draws
const longestGap = 1000; // ms; frames farther apart do not belong to one motion

/// How finely a frame is drawn.
export interface Detail {
  /// Factor of the width and the height in pixels.
  scale: number;
  mostPoints: number;
}

/// A frame as it was drawn. `moves`: something moves on. `isWhole`: it has all points.
export interface Drawn {
  moves: boolean;
  points: number;
  isWhole: boolean;
}

export const fine: Detail = { scale: 1, mostPoints: Infinity };

/// Calls `draw` for the frames that invalidate() asks for.
export class FrameClock {
  private request = 0;
  private settling: ReturnType<typeof setTimeout> | undefined;
  private lastFrame = -Infinity;
  private lastMotion = -Infinity;
  private measured = 0; // ms between frames while something moves; 0: not known
  private expected = 0; // ms between frames at the scale of now
  private isMoving = false; // the last frame was part of a motion
  private detail: Detail; // of moving pictures
  private last: { begin: number; points: number; isDrawn: boolean } = { begin: 0, points: 0, isDrawn: true }; // the last frame
  private isStopped = false;
  private heldUntil = -Infinity;
  private isReleased = false;
  private isCoarse = false; // the last frame was coarse
  private holding: ReturnType<typeof setTimeout> | undefined;

  /// `draw` gets the time in ms. `isSlow`: drawing a frame takes longer than the time to the next.
  constructor(
    private readonly draw: (now: number, detail: Detail) => Drawn,
    private readonly isSlow: boolean,
  ) {
    this.detail = isSlow ? { scale: 0.5, mostPoints: fewAtFirst } : fine;
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
    const begin = performance.now();
    const { moves, points, isWhole } = this.draw(now, isMoving ? this.detail : fine);
    this.last = { begin, points, isDrawn: false };
    if (moves) this.invalidate(true);
    this.isCoarse = isMoving && (this.detail.scale < 1 || !isWhole);
    if (!this.isSlow) this.settle();
  }

  /// Notes that the last frame is drawn. Returns how long that took, and whether the frame was fine; null where that is known already.
  drawn(): { points: number; milliseconds: number; isFine: boolean } | null {
    const { begin, points, isDrawn } = this.last;
    if (isDrawn) return null;
    this.last.isDrawn = true;
    const milliseconds = performance.now() - begin;
    // A graphics card has the time between frames, too, unless the gap was so long that it counts as a pause.
    if (this.isMoving && (this.isSlow || milliseconds > slowFrame)) this.adapt(milliseconds);
    if (this.isSlow) this.settle();
    return { points, milliseconds, isFine: !this.isMoving };
  }

  /// Draws a fine frame after a coarse one, unless another frame comes soon.
  private settle(): void {
    if (!this.isCoarse || this.isStopped) return;
    clearTimeout(this.settling);
    this.settling = setTimeout(() => this.invalidate(false), quiet + 20);
  }

  private measure(gap: number): void {
    this.measured = smooth(this.measured, gap);
    if (!this.isSlow) this.adapt(gap);
  }

  /// Draws moving pictures more coarsely, or more finely, after one that took so many milliseconds.
  private adapt(milliseconds: number): void {
    this.expected = smooth(this.expected, milliseconds);
    const { scale, mostPoints } = this.detail;
    const { points } = this.last;
    if (this.expected > slowFrame) {
      if (scale > coarse || (points <= fewest && scale > coarsest)) {
        this.detail = { scale: Math.max(coarsest, 0.8 * scale), mostPoints };
        this.expected *= 0.7; // coarser frames will take less
      } else if (points > fewest) {
        const share = Math.max(0.2, Math.min(0.8, slowFrame / this.expected));
        this.detail = { scale, mostPoints: Math.max(fewest, share * points) };
        this.expected *= share;
      }
    } else if (this.expected < fastFrame) {
      // Points that the bound leaves out come back before pixels do.
      if (mostPoints < 2 * points) this.detail = { scale, mostPoints: 1.05 * mostPoints };
      else if (scale < 1) this.detail = { scale: Math.min(1, 1.02 * scale), mostPoints };
    }
  }
}

const smooth = (before: number, now: number): number => (before > 0 ? 0.8 * before + 0.2 * now : now);
