// SPDX-License-Identifier: Apache-2.0
// The points of a decoded block, in the layout of a PointStore.

import { CurvecastError } from "./errors";

/// `count` points, in columns as those of PointStore.
export interface DecodedPoints {
  count: number;
  origin: [number, number, number];
  positions: Float32Array;
  normals: Int8Array;
  colours: Uint8Array | null;
  curvatures: Float32Array | null;
  ranks: Uint32Array | null;
  directions: Float32Array | null;
  scalars: readonly ScalarColumn[];
}

/// A number that the mesh has for each of its vertices, at the points: under the name that the mesh has for it, NaN and infinities as in
/// its file.
export interface ScalarColumn {
  name: string;
  values: Float32Array;
}

/// Makes the error for points that cannot be used: DATA_LOSS.
export function badPoints(why: string): CurvecastError {
  return new CurvecastError("DATA_LOSS", `the server sent bad points: ${why}`);
}

/// Throws DATA_LOSS where blocks do not belong to one set: their origins differ, or only some have a column.
export function checkAlike(blocks: readonly Omit<DecodedPoints, "count">[]): void {
  const [first, ...others] = blocks;
  if (first === undefined) return;
  for (const block of others) {
    if (block.origin.some((value, axis) => value !== first.origin[axis])) throw badPoints("blocks of different origins");
    for (const column of ["colours", "curvatures", "ranks", "directions"] as const) {
      if ((block[column] === null) !== (first[column] === null)) throw badPoints(`only some blocks have ${column}`);
    }
    const { scalars } = block;
    if (scalars.length !== first.scalars.length || scalars.some(({ name }, i) => name !== first.scalars[i]!.name)) {
      throw badPoints("blocks with different scalars");
    }
  }
}
