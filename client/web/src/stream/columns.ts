// SPDX-License-Identifier: Apache-2.0
// Writes packed values of points into the columns of a PointStore, which have four values a point.

import { badPoints, type DecodedPoints } from "./decoded_points";

/// Views bytes as floats. Precondition: their offset is a multiple of 4.
export function asFloats(bytes: Uint8Array): Float32Array {
  return new Float32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);
}

/// Writes x, y, z of each point. Throws DATA_LOSS where a value is not finite.
export function writePositions(from: Float32Array, { count, positions }: Pick<DecodedPoints, "count" | "positions">): void {
  let sum = 0; // NaN after a value that is not finite
  for (let i = 0; i < count; ++i) {
    const x = from[3 * i]!,
      y = from[3 * i + 1]!,
      z = from[3 * i + 2]!;
    positions[4 * i] = x;
    positions[4 * i + 1] = y;
    positions[4 * i + 2] = z;
    sum += 0 * x + 0 * y + 0 * z;
  }
  if (sum !== 0) throw badPoints("a position that is not finite");
}

/// Writes unit normals, 127 for 1. Throws DATA_LOSS where a value is not finite.
export function writeNormals(from: Float32Array, { count, normals }: Pick<DecodedPoints, "count" | "normals">): void {
  let sum = 0;
  for (let i = 0; i < count; ++i) {
    const x = from[3 * i]!,
      y = from[3 * i + 1]!,
      z = from[3 * i + 2]!;
    normals[4 * i] = Math.round(127 * x);
    normals[4 * i + 1] = Math.round(127 * y);
    normals[4 * i + 2] = Math.round(127 * z);
    sum += 0 * x + 0 * y + 0 * z;
  }
  if (sum !== 0) throw badPoints("a normal that is not finite");
}

/// Writes red, green and blue of each point, with an alpha of 255.
export function writeColours(rgb: Uint8Array, rgba: Uint8Array): void {
  for (let from = 0, to = 0; from < rgb.length; from += 3, to += 4) {
    rgba[to] = rgb[from]!;
    rgba[to + 1] = rgb[from + 1]!;
    rgba[to + 2] = rgb[from + 2]!;
    rgba[to + 3] = 255;
  }
}
