// SPDX-License-Identifier: Apache-2.0
// The trace of the brush: colours of the points, mixed with those of the paint over them.

import type { PointStore } from "../stream/point_store";
import type { PaintDab } from "./types";

type Rgb = readonly [number, number, number];

const clay: Rgb = [0xd2, 0xb7, 0x9f]; // sRGB, of surfaces without colours of their own
const dense: Rgb = [0xf2, 0x5c, 0x0a];
const sparse: Rgb = [0x1f, 0x6f, 0xe0];
const strongest = 64; // factor
const groupSize = 32;

/// Dabs that follow each other, and the box around them, relative to a store's origin.
interface Group {
  dabs: readonly PaintDab[];
  min: number[];
  max: number[];
}

function groupsOf(dabs: readonly PaintDab[], origin: readonly number[]): Group[] {
  const groups: Group[] = [];
  for (let begin = 0; begin < dabs.length; begin += groupSize) {
    const some = dabs.slice(begin, begin + groupSize);
    const side = (of: (...values: number[]) => number, sign: number): number[] =>
      [0, 1, 2].map((k) => of(...some.map(({ centre, radius }) => centre[k]! + sign * radius)) - origin[k]!);
    groups.push({ dabs: some, min: side(Math.min, -1), max: side(Math.max, 1) });
  }
  return groups.reverse(); // the last paint is on top
}

/// Returns the dab that is on top at a place relative to the origin; null where there is none.
function dabAt(groups: readonly Group[], origin: readonly number[], x: number, y: number, z: number): PaintDab | null {
  for (const { dabs, min, max } of groups) {
    if (x < min[0]! || y < min[1]! || z < min[2]! || x > max[0]! || y > max[1]! || z > max[2]!) continue;
    for (let i = dabs.length - 1; i >= 0; --i) {
      const { centre, radius } = dabs[i]!;
      const [dx, dy, dz] = [x + origin[0]! - centre[0], y + origin[1]! - centre[1], z + origin[2]! - centre[2]];
      if (dx * dx + dy * dy + dz * dz <= radius * radius) return dabs[i]!;
    }
  }
  return null;
}

/// How much of a point's colour is that of the paint: more for what changes the density more.
function coverOf(factor: number): number {
  if (factor === 1) return 0; // rubbed out
  return 0.35 + 0.4 * Math.min(1, Math.abs(Math.log2(Math.max(factor, 1 / strongest))) / Math.log2(strongest));
}

/// Computes the colours of points under paint: 4 a slot, as PointStore.colours. `ranges`: of slots, [begin, end) pairs.
export function paintPoints(store: PointStore, dabs: readonly PaintDab[], into: Uint8Array, ranges: readonly number[]): void {
  const { positions, colours, origin } = store;
  const groups = groupsOf(dabs, origin);
  for (let i = 0; i < ranges.length; i += 2) {
    for (let at = 4 * ranges[i]!; at < 4 * ranges[i + 1]!; at += 4) {
      const dab = dabAt(groups, origin, positions[at]!, positions[at + 1]!, positions[at + 2]!);
      const cover = dab === null ? 0 : coverOf(dab.factor);
      const paint = dab !== null && dab.factor < 1 ? sparse : dense;
      for (let k = 0; k < 3; ++k) into[at + k] = (colours?.[at + k] ?? clay[k]!) * (1 - cover) + paint[k]! * cover;
      into[at + 3] = 255;
    }
  }
}
