// SPDX-License-Identifier: Apache-2.0
// Points in the leaves of a balanced k-d tree, which any distribution of them leaves balanced. Bentley, "Multidimensional binary search
// trees used for associative searching", 1975. The tree is implicit: the node in place i of depth d has the points from i / 2^d to
// (i + 1) / 2^d of all.

const mostInLeaf = 24;

/// A tree, whose points are sorted: those of a leaf follow each other, and so do those of every other node.
export interface PointTree {
  readonly count: number;
  /// Of the leaves: there are 2^depth.
  readonly depth: number;
  /// 3 a point, in the order of the tree.
  readonly places: Float32Array;
  /// The number that each point had before.
  readonly from: Uint32Array;
  /// 6 a node: least and largest coordinates. Node 1 is the root, and those below node i are 2i and 2i + 1.
  readonly boxes: Float32Array;
}

/// Where the points of the `i`th node of a depth begin.
export const beginOf = (count: number, depth: number, i: number): number => Math.floor((count / 2 ** depth) * i);

/// Sorts points. `places`: 3 a point, all finite; the tree keeps and changes them. Every so many points of a tree are an even part.
export function makePointTree(places: Float32Array): PointTree {
  const count = places.length / 3;
  const depth = Math.max(0, Math.ceil(Math.log2(count / mostInLeaf)));
  const from = new Uint32Array(count);
  for (let i = 0; i < count; ++i) from[i] = i;
  const tree: PointTree = { count, depth, places, from, boxes: new Float32Array(6 * 2 ** (depth + 1)) };
  for (let level = 0; level <= depth; ++level) {
    for (let i = 0; i < 2 ** level; ++i) {
      const begin = beginOf(count, level, i);
      const end = beginOf(count, level, i + 1);
      const box = 6 * (2 ** level + i);
      measure(tree, begin, end, box);
      if (level < depth) split(tree, begin, beginOf(count, level + 1, 2 * i + 1), end, widest(tree.boxes, box));
    }
  }
  return tree;
}

function measure({ places, boxes }: PointTree, begin: number, end: number, box: number): void {
  let x0 = Infinity,
    y0 = Infinity,
    z0 = Infinity,
    x1 = -Infinity,
    y1 = -Infinity,
    z1 = -Infinity;
  for (let at = 3 * begin; at < 3 * end; at += 3) {
    const x = places[at]!,
      y = places[at + 1]!,
      z = places[at + 2]!;
    if (x < x0) x0 = x;
    if (y < y0) y0 = y;
    if (z < z0) z0 = z;
    if (x > x1) x1 = x;
    if (y > y1) y1 = y;
    if (z > z1) z1 = z;
  }
  boxes[box] = x0;
  boxes[box + 1] = y0;
  boxes[box + 2] = z0;
  boxes[box + 3] = x1;
  boxes[box + 4] = y1;
  boxes[box + 5] = z1;
}

/// Returns the axis along which a box is longest.
function widest(boxes: Float32Array, box: number): number {
  const [x, y, z] = [0, 1, 2].map((axis) => boxes[box + 3 + axis]! - boxes[box + axis]!) as [number, number, number];
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

/// Sorts [begin, end) so that what lies before the `middle`th point along an axis comes before it, and the others after. Hoare,
/// "Algorithm 65: find", 1961.
function split({ places, from }: PointTree, begin: number, middle: number, end: number, axis: number): void {
  let first = begin;
  let last = end - 1;
  while (first < last) {
    const pivot = medianOfThree(places[3 * first + axis]!, places[3 * ((first + last) >> 1) + axis]!, places[3 * last + axis]!);
    let i = first;
    let j = last;
    while (i <= j) {
      while (places[3 * i + axis]! < pivot) ++i;
      while (places[3 * j + axis]! > pivot) --j;
      if (i > j) break;
      swap(places, from, i, j);
      ++i;
      --j;
    }
    if (middle <= j) last = j;
    else if (middle >= i) first = i;
    else return;
  }
}

const medianOfThree = (a: number, b: number, c: number): number =>
  a < b ? (b < c ? b : a < c ? c : a) : a < c ? a : b < c ? c : b;

function swap(places: Float32Array, from: Uint32Array, i: number, j: number): void {
  const x = places[3 * i]!,
    y = places[3 * i + 1]!,
    z = places[3 * i + 2]!;
  places[3 * i] = places[3 * j]!;
  places[3 * i + 1] = places[3 * j + 1]!;
  places[3 * i + 2] = places[3 * j + 2]!;
  places[3 * j] = x;
  places[3 * j + 1] = y;
  places[3 * j + 2] = z;
  const number = from[i]!;
  from[i] = from[j]!;
  from[j] = number;
}
