// Points of a block, decoded, in the layout of PointStore.

import { CurvecastError } from "./errors";

/// A point set has at most so many.
export const maxPoints = 4_000_000;

/// `count` points; the columns as in PointStore.
export interface DecodedPoints {
  count: number;
  origin: [number, number, number];
  positions: Float32Array;
  normals: Int8Array;
  colours: Uint8Array | null;
  curvatures: Float32Array | null;
  ranks: Uint32Array | null;
}

/// Points that cannot be taken in: DATA_LOSS.
export function badPoints(why: string): CurvecastError {
  return new CurvecastError("DATA_LOSS", `the server sent bad points: ${why}`);
}

/// Throws where blocks do not belong into one set: other origins, or columns that only some have.
export function checkAlike(blocks: readonly Omit<DecodedPoints, "count">[]): void {
  const [first, ...others] = blocks;
  if (first === undefined) return;
  for (const block of others) {
    if (block.origin.some((value, axis) => value !== first.origin[axis])) throw badPoints("blocks of different origins");
    for (const column of ["colours", "curvatures", "ranks"] as const) {
      if ((block[column] === null) !== (first[column] === null)) throw badPoints(`only some blocks have ${column}`);
    }
  }
}
