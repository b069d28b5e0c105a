// SPDX-License-Identifier: Apache-2.0
// How many pixels the canvas has: as many as the screen has there, up to a bound, also after the page was zoomed or went to another
// screen.

interface Size {
  width: number;
  height: number;
}

/// Watches how many pixels of the screen a canvas covers. Calls `onChange` when that has changed, until dispose().
export class CanvasPixels {
  /// The most pixels per CSS pixel.
  maxRatio = 2;
  private exact: Size | null = null; // as the browser says, for the ratio and the place of then
  private readonly observer: ResizeObserver;
  private readonly ended = new AbortController();

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly onChange: () => void,
  ) {
    this.observer = new ResizeObserver((entries) => this.resized(entries));
    try {
      this.observer.observe(canvas, { box: "device-pixel-content-box" });
    } catch {
      this.observer.observe(canvas); // Safari
    }
    this.watchRatio();
  }

  /// Pixels per CSS pixel of a picture that is drawn with `scale` times the pixels in each direction.
  ratio(scale: number): number {
    return Math.min(window.devicePixelRatio || 1, this.maxRatio) * scale;
  }

  /// The size of each of `parts` pictures of one size beside each other.
  size(ratio: number, parts: number): Size {
    const { clientWidth, clientHeight } = this.canvas;
    const { exact } = this;
    // A canvas may begin within a pixel: what the browser says is up to one pixel from what its CSS size comes to. What differs by more
    // is of another ratio: before a zoom, or that of the screen where a device is emulated.
    const isExact = exact && Math.abs(exact.width - clientWidth * ratio) <= 1 && Math.abs(exact.height - clientHeight * ratio) <= 1;
    const { width, height } = isExact ? exact : { width: clientWidth * ratio, height: Math.round(clientHeight * ratio) };
    return { width: Math.max(1, Math.round(width / parts)), height: Math.max(1, height) };
  }

  dispose(): void {
    this.observer.disconnect();
    this.ended.abort();
  }

  private resized(entries: readonly ResizeObserverEntry[]): void {
    const box = (entries.at(-1) as Partial<ResizeObserverEntry> | undefined)?.devicePixelContentBoxSize?.[0];
    this.exact = box ? { width: box.inlineSize, height: box.blockSize } : null;
    this.onChange();
  }

  /// The size in CSS pixels may stay when the ratio changes.
  private watchRatio(): void {
    if (this.ended.signal.aborted) return;
    matchMedia(`(resolution: ${window.devicePixelRatio || 1}dppx)`).addEventListener(
      "change",
      () => {
        this.watchRatio();
        this.onChange();
      },
      { once: true, signal: this.ended.signal },
    );
  }
}
