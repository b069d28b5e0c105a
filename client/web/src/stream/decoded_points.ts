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
    for (const column of ["colours", "curvatures", "ranks"] as const) {
      if ((block[column] === null) !== (first[column] === null)) throw badPoints(`only some blocks have ${column}`);
    }
  }
}
