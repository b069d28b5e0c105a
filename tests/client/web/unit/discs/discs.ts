// Discs for tests, and the columns of a store that has them.

import type { Vec } from "../../../../../client/web/src/view/types";

export interface Disc {
  at: Vec;
  normal: Vec;
  radius: number;
}

/// Positions and normals as in a PointStore.
export function columnsOf(discs: readonly Disc[]): { positions: Float32Array; normals: Int8Array } {
  return {
    positions: Float32Array.from(discs.flatMap(({ at, radius }) => [...at, radius])),
    normals: Int8Array.from(discs.flatMap(({ normal }) => [...normal.map((value) => Math.round(127 * value)), 0])),
  };
}

/// A ball of radius 1 by the golden angle.
export function ball(count: number, radius: number): Disc[] {
  return Array.from({ length: count }, (_, i) => {
    const z = 1 - (2 * i + 1) / count;
    const [r, angle] = [Math.sqrt(1 - z * z), 2.399963 * i];
    const p: Vec = [r * Math.cos(angle), r * Math.sin(angle), z];
    return { at: p, normal: p, radius };
  });
}
