// Pictures: what is drawn in them, and how they differ. Masks have one byte for each pixel: 1 where something is.

import { writeFileSync } from "node:fs";

import { PNG, pictureFile } from "./environment.mjs";

/// {width, height, data: RGBA}. `name`: keeps a copy of it.
export function decode(bytes, name) {
  if (name !== undefined) writeFileSync(pictureFile(name), bytes);
  return PNG.sync.read(bytes);
}

/// Pixels in which two pictures of the same size differ by more than `tolerance` in a channel, as a mask.
export function difference(a, b, tolerance = 8) {
  if (a.width !== b.width || a.height !== b.height) throw new Error("pictures of different sizes");
  const mask = new Uint8Array(a.width * a.height);
  for (let i = 0; i < mask.length; ++i) {
    for (let k = 0; k < 3; ++k) {
      if (Math.abs(a.data[4 * i + k] - b.data[4 * i + k]) > tolerance) mask[i] = 1;
    }
  }
  return mask;
}

export function countOf(mask) {
  return mask.reduce((sum, value) => sum + value, 0);
}

/// {left, top, right, bottom}: the pixels of a mask lie between them.
export function boxOf(mask, width) {
  const box = { left: Infinity, top: Infinity, right: -1, bottom: -1 };
  mask.forEach((value, i) => {
    if (value === 0) return;
    const x = i % width,
      y = Math.floor(i / width);
    box.left = Math.min(box.left, x);
    box.right = Math.max(box.right, x);
    box.top = Math.min(box.top, y);
    box.bottom = Math.max(box.bottom, y);
  });
  return box;
}

/// Without the pixels that are less than `steps` from one that is not in it; what lies beyond the edge of the picture is not.
export function eroded(mask, width, steps) {
  let from = mask;
  for (let step = 0; step < steps; ++step) {
    const to = new Uint8Array(from.length);
    for (let i = 0; i < from.length; ++i) {
      const x = i % width;
      to[i] = x > 0 && x < width - 1 && from[i] && from[i - 1] && from[i + 1] && from[i - width] && from[i + width] ? 1 : 0;
    }
    from = to;
  }
  return from;
}

/// With the single pixels that four others surround: where a triangle has by chance the colour of the background.
export function filled(mask, width) {
  return mask.map((value, i) => value | (mask[i - 1] & mask[i + 1] & mask[i - width] & mask[i + width]));
}

/// Writes pictures beside each other.
export function writeBeside(name, ...pictures) {
  const out = new PNG({ width: pictures.reduce((sum, { width }) => sum + width, 0), height: pictures[0].height });
  let left = 0;
  for (const picture of pictures) {
    PNG.bitblt(picture, out, 0, 0, picture.width, picture.height, left, 0);
    left += picture.width;
  }
  writeFileSync(pictureFile(name), PNG.sync.write(out));
}
