// SPDX-License-Identifier: Apache-2.0
// Copies of what a canvas shows. A canvas of WebGL has to be drawn just before.

/// Returns the middle of a canvas, in the form of `width` x `height` pixels and of that size, as a data URL;
/// null where the browser cannot.
export function shrunk(canvas: HTMLCanvasElement, width: number, height: number): string | null {
  const small = Object.assign(document.createElement("canvas"), { width, height });
  const context = small.getContext("2d");
  if (context === null || canvas.width === 0 || canvas.height === 0) return null;
  const scale = Math.max(width / canvas.width, height / canvas.height);
  const [w, h] = [scale * canvas.width, scale * canvas.height];
  context.imageSmoothingQuality = "high";
  context.drawImage(canvas, (width - w) / 2, (height - h) / 2, w, h);
  return small.toDataURL("image/jpeg", 0.8);
}

/// Draws in CSS pixels of the page.
export type DrawOver = (context: CanvasRenderingContext2D) => void;

/// Copies a canvas that is `width` CSS pixels wide to all of another one, and draws over it.
export function copyTo(context: CanvasRenderingContext2D, canvas: HTMLCanvasElement, width: number, over: DrawOver): void {
  const to = context.canvas;
  context.drawImage(canvas, 0, 0, to.width, to.height);
  context.save();
  context.scale(to.width / width, to.width / width);
  over(context);
  context.restore();
}

/// Returns a canvas that is `width` CSS pixels wide as a PNG, with what is drawn over it.
export function pngOf(canvas: HTMLCanvasElement, width: number, over?: DrawOver): Promise<Blob> {
  let from = canvas;
  if (over) {
    from = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
    const context = from.getContext("2d");
    if (context === null) return Promise.reject(new Error("The picture cannot be copied."));
    copyTo(context, canvas, width, over);
  }
  return new Promise((resolve, reject) => {
    from.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("The picture cannot be read."))), "image/png");
  });
}
