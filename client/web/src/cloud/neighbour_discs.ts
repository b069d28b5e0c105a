// SPDX-License-Identifier: Apache-2.0
// Discs for points that have none: as large as the distance to their neighbours, in the plane of least squares through these. Hoppe,
// DeRose, Duchamp, McDonald, Stuetzle, "Surface reconstruction from unorganized points", SIGGRAPH 1992.

import { LeafNeighbours } from "./nearest_points";
import { makePointTree } from "./point_tree";

const neighbours = 10; // of a point
const closing = 6; // the neighbour up to which a disc reaches, of points that are each at a place of their own
const reach = 0.85; // radius over the distance of that neighbour
const largest = 5; // radius over the median radius
const smallest = 0.05;
const flat = 1e-4; // of a cross product over the square of the trace: less than that of points on a line
const loneRadius = 0.5; // of points all at one place

/// Discs in the order of a tree, of which every so many are an even part of the points.
export interface NeighbourDiscs {
  /// 4 a disc: x, y, z, radius.
  positions: Float32Array<ArrayBuffer>;
  /// 4 a disc: x, y, z of the unit normal, 1 = 127; 0. All 0 where neighbours lie on a line: such discs face the eye.
  normals: Int8Array<ArrayBuffer>;
  /// The number of each disc's point.
  from: Uint32Array<ArrayBuffer>;
}

/// Makes discs of points, 3 numbers each, which are used up. `given`: their normals, 3 a point, of any length; null, or all zero: that of
/// the neighbours' plane, away from the origin. `onProgress` is told the share that is done.
export function makeNeighbourDiscs(
  places: Float32Array,
  given: Float32Array | null,
  onProgress: (part: number) => void = () => {},
): NeighbourDiscs {
  const tree = makePointTree(places);
  const { count, depth, from } = tree;
  onProgress(0.3);
  const positions = new Float32Array(4 * count);
  const normals = new Int8Array(4 * count);
  const near = new LeafNeighbours(tree, Math.min(neighbours, Math.max(count - 1, 1)));
  const fit = new PlaneFit(places, near);
  const leaves = 2 ** depth;
  for (let leaf = 0; leaf < leaves; ++leaf) {
    near.find(leaf);
    for (let i = near.begin; i < near.end; ++i) {
      positions[4 * i] = places[3 * i]!;
      positions[4 * i + 1] = places[3 * i + 1]!;
      positions[4 * i + 2] = places[3 * i + 2]!;
      positions[4 * i + 3] = radiusAt(near, i);
      if (given === null || !writeNormal(normals, i, given[3 * from[i]!]!, given[3 * from[i]! + 1]!, given[3 * from[i]! + 2]!))
        fit.write(normals, i);
    }
    if (leaf % 1024 === 1023) onProgress(0.3 + (0.7 * leaf) / leaves);
  }
  boundRadii(positions, tree.boxes);
  return { positions, normals, from: from as Uint32Array<ArrayBuffer> };
}

/// Returns the radius of a disc; 0 where the neighbours do not tell.
function radiusAt({ squares, most, begin }: LeafNeighbours, i: number): number {
  const first = most * (i - begin);
  let same = 0; // neighbours at the point's own place
  while (same < most && squares[first + same] === 0) ++same;
  // Where places have several points each, the neighbours' do, too.
  let which = Math.min(same + closing * (same + 1), most) - 1;
  while (which > 0 && squares[first + which] === Infinity) --which;
  const square = squares[first + which]!;
  return square < Infinity ? reach * Math.sqrt(square) : 0;
}

/// Bounds radii by the median, for points far from all others, and gives one to those that have none.
function boundRadii(positions: Float32Array, boxes: Float32Array): void {
  const count = positions.length / 4;
  const step = Math.max(1, Math.floor(count / 10_000));
  const sample = Float32Array.from({ length: Math.ceil(count / step) }, (_, i) => positions[4 * step * i + 3]!)
    .filter((radius) => radius > 0)
    .sort();
  const diagonal = Math.hypot(...[0, 1, 2].map((axis) => boxes[9 + axis]! - boxes[6 + axis]!));
  const median = sample[sample.length >> 1] ?? (diagonal > 0 ? diagonal / 100 : loneRadius);
  for (let at = 3; at < positions.length; at += 4) {
    const radius = positions[at]!;
    positions[at] = radius > 0 ? Math.min(Math.max(radius, smallest * median), largest * median) : median;
  }
}

/// Writes a vector of any length as a unit normal. Returns false where it has no direction.
function writeNormal(normals: Int8Array, i: number, x: number, y: number, z: number): boolean {
  const size = Math.sqrt(x * x + y * y + z * z);
  if (!(size > 1e-30 && size < Infinity)) return false;
  normals[4 * i] = Math.round((127 * x) / size);
  normals[4 * i + 1] = Math.round((127 * y) / size);
  normals[4 * i + 2] = Math.round((127 * z) / size);
  return true;
}

/// Fits planes to a point and its neighbours.
class PlaneFit {
  private readonly covariance = new Float64Array(6); // xx, xy, xz, yy, yz, zz
  private readonly normal = new Float64Array(3);

  constructor(
    private readonly places: Float32Array,
    private readonly near: LeafNeighbours,
  ) {}

  /// Writes the normal of the plane through the neighbours of point `i`; nothing where it is not determined.
  write(normals: Int8Array, i: number): void {
    const { normal, places } = this;
    this.gather(i);
    if (!leastAxis(this.covariance, normal)) return;
    const x = normal[0]!,
      y = normal[1]!,
      z = normal[2]!;
    const side = x * places[3 * i]! + y * places[3 * i + 1]! + z * places[3 * i + 2]! < 0 ? -1 : 1;
    writeNormal(normals, i, side * x, side * y, side * z);
  }

  /// Sets the covariance of a point and its neighbours, in units of the farthest one's distance.
  private gather(i: number): void {
    const { covariance, places } = this;
    const { numbers, squares, most, begin } = this.near;
    const first = most * (i - begin);
    covariance.fill(0);
    let last = first + most - 1;
    while (last > first && squares[last] === Infinity) --last;
    const unit = 1 / Math.sqrt(squares[last]!);
    if (!(unit < Infinity && unit > 0)) return;
    let sx = 0,
      sy = 0,
      sz = 0,
      xx = 0,
      xy = 0,
      xz = 0,
      yy = 0,
      yz = 0,
      zz = 0;
    for (let k = first; k <= last; ++k) {
      const other = 3 * numbers[k]!;
      const x = (places[other]! - places[3 * i]!) * unit;
      const y = (places[other + 1]! - places[3 * i + 1]!) * unit;
      const z = (places[other + 2]! - places[3 * i + 2]!) * unit;
      sx += x;
      sy += y;
      sz += z;
      xx += x * x;
      xy += x * y;
      xz += x * z;
      yy += y * y;
      yz += y * z;
      zz += z * z;
    }
    const share = 1 / (last - first + 2); // the point itself is at 0
    covariance[0] = xx - share * sx * sx;
    covariance[1] = xy - share * sx * sy;
    covariance[2] = xz - share * sx * sz;
    covariance[3] = yy - share * sy * sy;
    covariance[4] = yz - share * sy * sz;
    covariance[5] = zz - share * sz * sz;
  }
}

/// Finds the eigenvector of a symmetric 3 x 3 matrix' least eigenvalue, of any length. Returns false where it is not determined. Smith,
/// "Eigenvalues of a symmetric 3 x 3 matrix", 1961.
function leastAxis(matrix: Float64Array, into: Float64Array): boolean {
  const xx = matrix[0]!,
    xy = matrix[1]!,
    xz = matrix[2]!,
    yy = matrix[3]!,
    yz = matrix[4]!,
    zz = matrix[5]!;
  const trace = xx + yy + zz;
  if (!(trace > 0)) return false;
  const mean = trace / 3;
  const a = xx - mean,
    b = yy - mean,
    c = zz - mean;
  const spread = Math.sqrt((a * a + b * b + c * c + 2 * (xy * xy + xz * xz + yz * yz)) / 6);
  if (!(spread > 1e-9 * trace)) return false; // a ball of points
  const half = (a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz)) / (2 * spread ** 3);
  const angle = Math.acos(Math.min(Math.max(half, -1), 1)) / 3;
  const least = mean + 2 * spread * Math.cos(angle + (2 * Math.PI) / 3);
  const x = xx - least,
    y = yy - least,
    z = zz - least;
  // The rows of the matrix without that eigenvalue are all across the axis: the largest product of two of them is along it.
  let most = 0;
  const take = (px: number, py: number, pz: number): void => {
    const size = px * px + py * py + pz * pz;
    if (size <= most) return;
    most = size;
    into[0] = px;
    into[1] = py;
    into[2] = pz;
  };
  take(xy * yz - xz * y, xz * xy - x * yz, x * y - xy * xy);
  take(xy * z - xz * yz, xz * xz - x * z, x * yz - xy * xz);
  take(y * z - yz * yz, yz * xz - xy * z, xy * yz - y * xz);
  return Math.sqrt(most) > flat * trace * trace;
}
