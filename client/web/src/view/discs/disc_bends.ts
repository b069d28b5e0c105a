// SPDX-License-Identifier: Apache-2.0
// How the surface bends around each disc, so that the disc ends at an outline where the surface does.

import type { BentCells } from "./bent_cells";
import { stride, type DiscGrid } from "./disc_grid";

const flatCosine = 0.9986; // 3 degrees
const nearby = 1.6; // radii: neighbours whose normals tell how the surface bends
const farthest = 2; // radii: neighbours whose places do
const nearest = 0.5; // radii: at a smaller distance, a height says nothing
const leastScale = 0.9; // of radii that reach all neighbours
const crowd = 1 << 12; // pairs of two cells' discs: where there are more, discs lie on one another
const minDeterminant = 0.05; // of the neighbours' moments, in squares of their mean: below, they lie on a line

/// Directions in the plane of a disc for which bends are found, from its first vector to the second and on around.
export const directions = 8;
const cosines = Float64Array.from({ length: directions + 1 }, (_, k) => Math.cos((2 * Math.PI * k) / directions));
const sines = Float64Array.from({ length: directions + 1 }, (_, k) => Math.sin((2 * Math.PI * k) / directions));
export const largestBend = 4; // what bends more is taken for it
const nobody = 255; // a byte: in this direction, there is no neighbour

/// Sums of a disc over its neighbours, which lie at (u, v) in its plane, where normals lean by (du, dv): u u, u v, v v, u du, u dv + v du,
/// v dv.
const sums = 6;

/// Returns how far the surface bends from the planes of discs, 8 bytes for each of `slots` slots. On the way of a radius in a direction,
/// normals lean by the bend, and the surface falls by half a radius times it. It is that of the neighbours' normals, or that of those
/// places beyond the disc that hide the least, whichever is more: where a surface is rough, normals do not tell where it ends. A byte of
/// 1 to 254 is the root of bend / largestBend; 0: there is no disc; 255: the surface is not flat, and has no neighbour in this direction. `scale`: the factor of the radii in the grid; bends are for 1.
/// `creaseCosine`: of normals; what turns by more lies beyond a crease.
export function findDiscBends(
  grid: DiscGrid,
  bent: BentCells,
  slots: number,
  scale: number,
  creaseCosine: number,
): Uint8Array<ArrayBuffer> {
  const { count, discs } = grid;
  const { moments, fallen, isBent } = lookAround(grid, bent, creaseCosine);
  const bends = new Uint8Array(directions * slots);
  const form = new Float64Array(3);
  for (let disc = 0; disc < count; ++disc) {
    const isUnknown = isBent[disc] === 0 || scale < leastScale; // what lies where there is nobody
    formOf(moments, sums * disc, form);
    const radius = discs[stride * disc + 3]!;
    for (let k = 0; k < directions; ++k) {
      const [c, d] = [cosines[k]!, sines[k]!];
      const leaning = form[0]! * c * c + 2 * form[1]! * c * d + form[2]! * d * d;
      const arc = fallen[directions * disc + k]!;
      const bend = (Math.max(leaning, arc < Infinity ? arc : 0, 0) * radius) / scale;
      const byte = 1 + Math.round(253 * Math.sqrt(Math.min(1, bend / largestBend)));
      bends[directions * grid.slots[disc]! + k] = arc < Infinity || isUnknown ? byte : nobody;
    }
  }
  return bends;
}

/// Two unit vectors in the plane of a disc, at right angles. Shaders compute them anew: Duff et al., "Building an Orthonormal Basis,
/// Revisited", JCGT 2017.
function planeOf(x: number, y: number, z: number): [number, number, number, number, number, number] {
  const sign = z >= 0 ? 1 : -1;
  const a = -1 / (sign + z);
  const b = x * y * a;
  return [1 + sign * x * x * a, sign * b, -sign * x, b, sign + y * y * a, -y];
}

/// The octant in which a direction lies.
function octantOf(u: number, v: number): number {
  if (v >= 0) return u >= 0 ? (u >= v ? 0 : 1) : -u < v ? 2 : 3;
  return u < 0 ? (u < v ? 4 : 5) : u < -v ? 6 : 7;
}

/// What the neighbours of all discs tell.
interface Around {
  moments: Float32Array; // of their normals
  fallen: Float32Array; // the least curvature of arcs to them in each direction; Infinity: there is nobody
  isBent: Uint8Array; // 1: some of their normals are other ones
}

function lookAround(grid: DiscGrid, bent: BentCells, creaseCosine: number): Around {
  const { count, discs, cells } = grid;
  const planes = new Float32Array(6 * count);
  for (let disc = 0, i = 4; disc < count; ++disc, i += stride)
    planes.set(planeOf(discs[i]!, discs[i + 1]!, discs[i + 2]!), 6 * disc);
  const moments = new Float32Array(sums * count);
  const fallen = new Float32Array(directions * count).fill(Infinity);
  const isBent = new Uint8Array(count);

  /// The disc i has j at (x, y, z) from itself.
  const see = (i: number, j: number, x: number, y: number, z: number, square: number, cosine: number): void => {
    const isCrease = cosine < creaseCosine;
    const [at, to, p] = [stride * i, stride * j, 6 * i];
    const radius = discs[at + 3]!;
    if (square > (farthest * radius) ** 2) return;
    const u = x * planes[p]! + y * planes[p + 1]! + z * planes[p + 2]!;
    const v = x * planes[p + 3]! + y * planes[p + 4]! + z * planes[p + 5]!;
    const fall = -2 * (x * discs[at + 4]! + y * discs[at + 5]! + z * discs[at + 6]!);
    // The two directions between which it lies: in the others, it is more than 45 degrees aside.
    const first = octantOf(u, v);
    for (let k = first; k < first + 2; ++k) {
      const along = u * cosines[k]! + v * sines[k]!;
      if (along < nearest * radius && !isCrease) continue;
      const to = directions * i + (k & 7);
      const curvature = isCrease
        ? 0 // the disc ends at the crease
        : fall / (along * along);
      if (curvature < fallen[to]!) fallen[to] = curvature;
    }
    if (isCrease || square > (nearby * radius) ** 2) return;
    if (cosine < flatCosine) isBent[i] = 1;
    const dx = discs[to + 4]! - discs[at + 4]!;
    const dy = discs[to + 5]! - discs[at + 5]!;
    const dz = discs[to + 6]! - discs[at + 6]!;
    const du = dx * planes[p]! + dy * planes[p + 1]! + dz * planes[p + 2]!;
    const dv = dx * planes[p + 3]! + dy * planes[p + 4]! + dz * planes[p + 5]!;
    const m = sums * i;
    moments[m]! += u * u;
    moments[m + 1]! += u * v;
    moments[m + 2]! += v * v;
    moments[m + 3]! += u * du;
    moments[m + 4]! += u * dv + v * du;
    moments[m + 5]! += v * dv;
  };

  const { begin } = cells;
  for (let a = 0; a < cells.count; ++a) {
    bent.forEachAround(a, (b) => {
      if (b < a || (begin[a + 1]! - begin[a]!) * (begin[b + 1]! - begin[b]!) > crowd) return;
      for (let i = begin[a]!; i < begin[a + 1]!; ++i) {
        const at = stride * i;
        for (let j = a === b ? i + 1 : begin[b]!; j < begin[b + 1]!; ++j) {
          const to = stride * j;
          const x = discs[to]! - discs[at]!;
          const y = discs[to + 1]! - discs[at + 1]!;
          const z = discs[to + 2]! - discs[at + 2]!;
          const square = x * x + y * y + z * z;
          if (square > (farthest * Math.max(discs[at + 3]!, discs[to + 3]!)) ** 2) continue;
          const cosine = discs[at + 4]! * discs[to + 4]! + discs[at + 5]! * discs[to + 5]! + discs[at + 6]! * discs[to + 6]!;
          see(i, j, x, y, z, square, cosine);
          see(j, i, -x, -y, -z, square, cosine);
        }
      }
    });
  }
  return { moments, fallen, isBent };
}

/// The symmetric matrix S of least squares of S (u, v) - (du, dv): its first, its mixed, its last number. Zeros where nothing tells.
function formOf(moments: Float32Array, m: number, form: Float64Array): void {
  const mean = 0.5 * (moments[m]! + moments[m + 2]!);
  const uu = moments[m]! + 1e-3 * mean;
  const uv = moments[m + 1]!;
  const vv = moments[m + 2]! + 1e-3 * mean;
  const determinant = uu * vv - uv * uv;
  form.fill(0);
  if (!(determinant > minDeterminant * mean * mean)) return;
  const a = moments[m + 3]!;
  const d = moments[m + 5]!;
  form[1] = (moments[m + 4]! - (uv * a) / uu - (uv * d) / vv) / ((uu + vv) * (determinant / (uu * vv)));
  form[0] = (a - form[1] * uv) / uu;
  form[2] = (d - form[1] * uv) / vv;
}
