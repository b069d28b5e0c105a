// SPDX-License-Identifier: Apache-2.0
// Where discs end before their rim: along creases, where the surface goes on in another direction.
//
// A disc that reaches over a crease would stick out of the surface. What each side of one has is its plane: both discs end
// where their planes meet. The rule, and its numbers, are those of core/render/disc_ends.cpp.

import { usualCreaseDegrees } from "../../stream/point_store";
import { findBentCells, largestRadius, squareToBox, type BentCells } from "./bent_cells";
import { findDiscBends } from "./disc_bends";
import { makeGrid, stride, type DiscGrid } from "./disc_grid";

const neighbours = 24; // a disc and those nearest to it
const leastCrease = 5; // degrees: normals are rounded
const sheetCosine = -0.95; // beyond, both are sides of something thin, whose planes meet anywhere
const reach = 1.4; // radii from a disc's middle within which it is drawn
export const slack = 0.01; // radii that discs overlap by at a crease
const flat = 0.05; // radii: heights over a plane that say nothing
const otherLine = 0.87; // cosine: lines in directions less alike are two, as at a corner

/// Discs that end at creases: their slots, and 8 numbers each: the normals of two planes, and how far they are from the disc's middle. A
/// disc is drawn where it is below both. A plane of zeros ends nothing. `bends`: where the discs of all slots end at outlines, as
/// findDiscBends() returns them.
export interface DiscEnds {
  slots: Uint32Array;
  planes: Float32Array;
  bends: Uint8Array<ArrayBuffer>;
}

/// Finds where discs end. The columns of `slots` slots are those of a PointStore; radii are multiplied by `scale`. Neighbours whose normals
/// are further apart than `creaseDegrees`, and than what rounding makes of normals, lie on two sides of a crease.
export function findDiscEnds(
  positions: Float32Array,
  normals: Int8Array,
  slots: number,
  scale = 1,
  creaseDegrees = usualCreaseDegrees,
): DiscEnds {
  const crease = (Math.PI / 180) * Math.max(creaseDegrees, leastCrease);
  const creaseCosine = Math.cos(crease);
  const grid = makeGrid(positions, normals, slots, scale);
  const bent = findBentCells(grid, crease);
  const found: number[] = [];
  const planes: number[] = [];
  const { begin, count } = grid.cells;
  for (let cell = 0; cell < count; ++cell) {
    const around = bent.around(cell);
    if (around === null) continue;
    for (let disc = begin[cell]!; disc < begin[cell + 1]!; ++disc) {
      const ends = endsOf(grid, bent, around, disc, creaseCosine);
      if (ends.length === 0) continue;
      found.push(grid.slots[disc]!);
      for (let i = 0; i < 8; ++i) planes.push(ends[i >> 2]?.plane[i & 3] ?? 0);
    }
  }
  return {
    slots: Uint32Array.from(found),
    planes: Float32Array.from(planes),
    bends: findDiscBends(grid, bent, slots, scale, creaseCosine),
  };
}

/// The plane of a neighbour that ends a disc: normal, and distance from the disc's middle; `across`: unit, in the disc's
/// plane, from its middle to the line.
interface End {
  square: number; // of the distance between the middles
  radius: number; // the neighbour's
  across: [number, number, number];
  plane: [number, number, number, number];
}

function endBy(discs: Float32Array, disc: number, other: number): End | null {
  const [i, j] = [stride * disc, stride * other];
  const [nx, ny, nz, mx, my, mz] = [discs[i + 4]!, discs[i + 5]!, discs[i + 6]!, discs[j + 4]!, discs[j + 5]!, discs[j + 6]!];
  const [radius, itsRadius] = [discs[i + 3]!, discs[j + 3]!];
  const [x, y, z] = [discs[j]! - discs[i]!, discs[j + 1]! - discs[i + 1]!, discs[j + 2]! - discs[i + 2]!];
  const cosine = nx * mx + ny * my + nz * mz;
  const larger = Math.max(radius, itsRadius);
  const sine = Math.sqrt(1 - cosine * cosine);
  const itsHeight = x * nx + y * ny + z * nz;
  const height = -(x * mx + y * my + z * mz);
  // Of a ridge each middle lies below the other's plane, of a valley above. Else the surface turns between them in some other
  // way.
  if (Math.min(Math.abs(itsHeight), Math.abs(height)) > flat * larger && itsHeight * height < 0) return null;
  if (Math.abs(height) > reach * radius * sine || Math.abs(itsHeight) > reach * itsRadius * sine) return null;
  const along = x * (ny * mz - nz * my) + y * (nz * mx - nx * mz) + z * (nx * my - ny * mx);
  if (Math.abs(along) > larger * sine) return null; // too far along the line
  const outward = itsHeight + height < 0 ? 1 : -1; // of a ridge, of a valley
  const across = (m: number, n: number): number => (outward * (m - cosine * n)) / sine;
  return {
    square: x * x + y * y + z * z,
    radius: itsRadius,
    across: [across(mx, nx), across(my, ny), across(mz, nz)],
    plane: [outward * mx, outward * my, outward * mz, slack * radius - outward * height],
  };
}

type Around = NonNullable<ReturnType<BentCells["around"]>>;

/// Returns the planes at which a disc ends: two at most.
function endsOf(grid: DiscGrid, bent: BentCells, around: Around, disc: number, creaseCosine: number): End[] {
  const ends = endsAround(grid, bent, around, disc, creaseCosine);
  if (ends === null) return [];
  const first = nearest(ends);
  if (!isNear(grid, bent, around, disc, first)) return [];
  const [x, y, z] = first.across;
  const others = ends.filter(({ across }) => x * across[0] + y * across[1] + z * across[2] <= otherLine);
  if (others.length === 0) return [first];
  const second = nearest(others);
  return isNear(grid, bent, around, disc, second) ? [first, second] : [first];
}

const nearest = (ends: readonly End[]): End => ends.reduce((best, end) => (end.square < best.square ? end : best));

function endsAround(
  grid: DiscGrid,
  { summaries, lists }: BentCells,
  { begin, bent }: Around,
  disc: number,
  creaseCosine: number,
): End[] | null {
  const { discs, cells } = grid;
  const i = stride * disc;
  const [x, y, z, radius] = [discs[i]!, discs[i + 1]!, discs[i + 2]!, discs[i + 3]!];
  const [nx, ny, nz] = [discs[i + 4]!, discs[i + 5]!, discs[i + 6]!];
  let ends: End[] | null = null;
  for (let k = begin; k < bent; ++k) {
    const cell = lists[k]!;
    const farthest = radius + largestRadius(summaries, cell);
    if (squareToBox(summaries, cell, x, y, z) > farthest * farthest) continue;
    for (let other = cells.begin[cell]!; other < cells.begin[cell + 1]!; ++other) {
      const j = stride * other;
      const cosine = nx * discs[j + 4]! + ny * discs[j + 5]! + nz * discs[j + 6]!;
      if (cosine > creaseCosine || cosine < sheetCosine) continue;
      const dx = discs[j]! - x;
      const dy = discs[j + 1]! - y;
      const dz = discs[j + 2]! - z;
      const both = radius + discs[j + 3]!;
      if (dx * dx + dy * dy + dz * dz > both * both) continue;
      const end = endBy(discs, disc, other);
      if (end !== null) (ends ??= []).push(end);
    }
  }
  return ends;
}

/// Whether the neighbour of an end is among the nearest, of those that are not far smaller than it: points may be dense on
/// the side of a crease that is seen, and sparse on the other.
function isNear(grid: DiscGrid, { summaries, lists }: BentCells, { begin, end }: Around, disc: number, found: End): boolean {
  const { discs, cells } = grid;
  const { square } = found;
  const least = 0.5 * found.radius;
  const i = stride * disc;
  const [x, y, z] = [discs[i]!, discs[i + 1]!, discs[i + 2]!];
  let nearer = 0;
  for (let k = begin; k < end; ++k) {
    const cell = lists[k]!;
    if (squareToBox(summaries, cell, x, y, z) >= square || largestRadius(summaries, cell) < least) continue;
    for (let j = stride * cells.begin[cell]!; j < stride * cells.begin[cell + 1]!; j += stride) {
      const dx = discs[j]! - x;
      const dy = discs[j + 1]! - y;
      const dz = discs[j + 2]! - z;
      if (dx * dx + dy * dy + dz * dz < square && discs[j + 3]! >= least && ++nearer >= neighbours) return false;
    }
  }
  return true;
}
