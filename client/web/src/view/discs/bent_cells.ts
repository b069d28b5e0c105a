// SPDX-License-Identifier: Apache-2.0
// Which cells of a grid may have discs that meet in a crease. Most cells of most surfaces have none: the normals in them and
// around them lie in a narrow cone.

import { forEachPair, stride, type DiscGrid } from "./disc_grid";

/// Pairs of a cell's discs and those around: where there are more, discs lie on one another, and no crease shows.
const crowd = 1 << 16;

/// Numbers of a cell in `summaries`: axis and angle of a cone around its normals, the box of the middles, the largest radius.
const summarySize = 11;

export interface BentCells {
  summaries: Float32Array;
  /// The neighbours of a cell: those with which it may have a crease, from begin to bent, and others, from bent to end, in
  /// `lists`. null: it has no crease.
  around(cell: number): { begin: number; bent: number; end: number } | null;
  /// Calls `visit` for all neighbours of a cell, itself among them.
  forEachAround(cell: number, visit: (other: number) => void): void;
  lists: Uint32Array;
}

/// `crease`: an angle, in radians; surfaces that turn by less between two discs are smooth.
export function findBentCells(grid: DiscGrid, crease: number): BentCells {
  const { count, begin } = grid.cells;
  const summaries = summariesOf(grid);
  const bents = new Uint32Array(count); // neighbours with which there may be a crease
  const ends = new Uint32Array(count + 1); // of the lists of the cells
  let pairs = new Uint32Array(16 * count + 16); // two cells, the second with whether they are bent in its lowest bit
  let size = 0;
  forEachPair(grid, (a, b) => {
    if (areApart(summaries, a, b)) return;
    const bent = areBent(summaries, a, b, crease) ? 1 : 0;
    if (size + 2 > pairs.length) {
      const larger = new Uint32Array(2 * pairs.length);
      larger.set(pairs);
      pairs = larger;
    }
    pairs[size++] = a;
    pairs[size++] = 2 * b + bent;
    ++ends[a]!;
    bents[a]! += bent;
    if (a === b) return;
    ++ends[b]!;
    bents[b]! += bent;
  });
  for (let cell = 0; cell < count; ++cell) ends[cell + 1]! += ends[cell]!;
  const lists = new Uint32Array(ends[count]!);
  const starts = ends.slice();
  for (let wanted = 0; wanted < 2; ++wanted) {
    // Lists are filled from their ends: the bent ones come last, and stand first.
    for (let i = 0; i < size; i += 2) {
      const [a, b] = [pairs[i]!, pairs[i + 1]! >>> 1];
      if ((pairs[i + 1]! & 1) !== wanted) continue;
      lists[--starts[a]!] = b;
      if (a !== b) lists[--starts[b]!] = a;
    }
  }
  return {
    summaries,
    lists,
    forEachAround(cell, visit) {
      for (let i = starts[cell]!; i < ends[cell]!; ++i) visit(lists[i]!);
    },
    around(cell) {
      if (bents[cell] === 0) return null;
      const [from, end] = [starts[cell]!, ends[cell]!];
      let discs = 0;
      for (let i = from; i < end; ++i) discs += begin[lists[i]! + 1]! - begin[lists[i]!]!;
      return discs * (begin[cell + 1]! - begin[cell]!) > crowd ? null : { begin: from, bent: from + bents[cell]!, end };
    },
  };
}

/// The square of the distance from a place to the box of a cell's middles.
export function squareToBox(summaries: Float32Array, cell: number, x: number, y: number, z: number): number {
  const at = summarySize * cell;
  const dx = Math.max(summaries[at + 4]! - x, 0, x - summaries[at + 7]!);
  const dy = Math.max(summaries[at + 5]! - y, 0, y - summaries[at + 8]!);
  const dz = Math.max(summaries[at + 6]! - z, 0, z - summaries[at + 9]!);
  return dx * dx + dy * dy + dz * dz;
}

export const largestRadius = (summaries: Float32Array, cell: number): number => summaries[summarySize * cell + 10]!;

function areApart(summaries: Float32Array, a: number, b: number): boolean {
  const [i, j] = [summarySize * a, summarySize * b];
  let square = 0;
  for (let k = 0; k < 3; ++k) {
    const gap = Math.max(0, summaries[i + 4 + k]! - summaries[j + 7 + k]!, summaries[j + 4 + k]! - summaries[i + 7 + k]!);
    square += gap * gap;
  }
  const reach = summaries[i + 10]! + summaries[j + 10]!;
  return square > reach * reach;
}

function areBent(summaries: Float32Array, a: number, b: number, crease: number): boolean {
  const [i, j] = [summarySize * a, summarySize * b];
  const spread = summaries[i + 3]! + summaries[j + 3]!;
  if (spread >= crease) return true;
  let cosine = 0;
  for (let k = 0; k < 3; ++k) cosine += summaries[i + k]! * summaries[j + k]!;
  return cosine <= Math.cos(crease - spread);
}

function summariesOf({ discs, cells: { count, begin } }: DiscGrid): Float32Array {
  const summaries = new Float32Array(summarySize * count);
  for (let cell = 0; cell < count; ++cell) {
    const [from, to, at] = [stride * begin[cell]!, stride * begin[cell + 1]!, summarySize * cell];
    summaries.fill(Infinity, at + 4, at + 7);
    summaries.fill(-Infinity, at + 7, at + 10);
    for (let i = from; i < to; i += stride) {
      for (let k = 0; k < 3; ++k) {
        summaries[at + k]! += discs[i + 4 + k]!;
        summaries[at + 4 + k] = Math.min(summaries[at + 4 + k]!, discs[i + k]!);
        summaries[at + 7 + k] = Math.max(summaries[at + 7 + k]!, discs[i + k]!);
      }
      summaries[at + 10] = Math.max(summaries[at + 10]!, discs[i + 3]!);
    }
    const [x, y, z] = [summaries[at]!, summaries[at + 1]!, summaries[at + 2]!];
    const size = Math.sqrt(x * x + y * y + z * z);
    let least = size > 1e-3 ? 1 : -1; // cosine of the angle
    for (let i = from; i < to && least > -1; i += stride)
      least = Math.min(least, Math.max(-1, (discs[i + 4]! * x + discs[i + 5]! * y + discs[i + 6]! * z) / size));
    for (let k = 0; k < 3; ++k) summaries[at + k]! /= size;
    summaries[at + 3] = Math.acos(least);
  }
  return summaries;
}
