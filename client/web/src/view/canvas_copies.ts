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

/// Returns a canvas as a PNG.
export function pngOf(canvas: HTMLCanvasElement): Promise<Blob> {
  return new Promise((resolve, reject) => {
    canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("The picture cannot be read."))), "image/png");
  });
}
