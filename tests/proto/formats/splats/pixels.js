// What a canvas shows.

const STEP = 8192; // bytes: arguments of one call

/** Returns red, green, blue and alpha of each pixel, from the lowest row up, in base 64. */
export function readPixels(gl, width, height) {
  const bytes = new Uint8Array(4 * width * height);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  let text = "";
  for (let i = 0; i < bytes.length; i += STEP) text += String.fromCharCode(...bytes.subarray(i, i + STEP));
  return btoa(text);
}
