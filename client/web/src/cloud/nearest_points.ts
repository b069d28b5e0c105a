// SPDX-License-Identifier: Apache-2.0
// The nearest neighbours of all points of a tree, leaf by leaf: the points of a leaf have most of their neighbours in common.

import { beginOf, type PointTree } from "./point_tree";

/// The neighbours of the points of one leaf, `most` of each: nearest first, and each with the square of its distance.
export class LeafNeighbours {
  begin = 0;
  end = 0;
  /// `most` a point of the leaf; those that there are not are -1, at an infinite distance.
  readonly numbers: Int32Array;
  readonly squares: Float64Array;
  private readonly waiting = new Int32Array(64); // nodes
  private farthest = Infinity; // the largest square within which nearer neighbours have to be

  constructor(
    private readonly tree: PointTree,
    readonly most: number,
  ) {
    const room = Math.ceil(tree.count / 2 ** tree.depth) + 1;
    this.numbers = new Int32Array(room * most);
    this.squares = new Float64Array(room * most);
  }

  /// Finds the neighbours of the points of the `i`th leaf, which are those from `begin` to `end`.
  find(i: number): void {
    const { tree } = this;
    this.begin = beginOf(tree.count, tree.depth, i);
    this.end = beginOf(tree.count, tree.depth, i + 1);
    const size = this.most * (this.end - this.begin);
    this.numbers.fill(-1, 0, size);
    this.squares.fill(Infinity, 0, size);
    const leaf = 2 ** tree.depth + i;
    this.compare(i);
    // What is beside the leaf first, then beside its parent, and so on: the nearest are there in most cases.
    for (let node = leaf; node > 1; node >>= 1) this.search(node ^ 1, 6 * leaf);
  }

  /// Looks for neighbours below a node.
  private search(node: number, leafBox: number): void {
    const { waiting } = this;
    const leaves = 2 ** this.tree.depth;
    let waits = 0;
    waiting[waits++] = node;
    while (waits > 0) {
      const at = waiting[--waits]!;
      if (this.gapTo(6 * at, leafBox) >= this.farthest) continue;
      if (at < leaves) {
        waiting[waits++] = 2 * at;
        waiting[waits++] = 2 * at + 1;
      } else {
        this.compare(at - leaves);
      }
    }
  }

  /// The square of the distance of two nodes' boxes.
  private gapTo(box: number, other: number): number {
    const { boxes } = this.tree;
    const x = Math.max(boxes[box]! - boxes[other + 3]!, boxes[other]! - boxes[box + 3]!, 0);
    const y = Math.max(boxes[box + 1]! - boxes[other + 4]!, boxes[other + 1]! - boxes[box + 4]!, 0);
    const z = Math.max(boxes[box + 2]! - boxes[other + 5]!, boxes[other + 2]! - boxes[box + 5]!, 0);
    return x * x + y * y + z * z;
  }

  /// Takes the points of another leaf, or of the same, as neighbours where they are nearer than others.
  private compare(leaf: number): void {
    const { squares, most, begin, end: pointsEnd } = this;
    const { places, boxes, count, depth } = this.tree;
    const first = beginOf(count, depth, leaf);
    const end = beginOf(count, depth, leaf + 1);
    const box = 6 * (2 ** depth + leaf);
    const x0 = boxes[box]!,
      y0 = boxes[box + 1]!,
      z0 = boxes[box + 2]!,
      x1 = boxes[box + 3]!,
      y1 = boxes[box + 4]!,
      z1 = boxes[box + 5]!;
    let farthest = 0;
    for (let point = begin, last = most - 1; point < pointsEnd; ++point, last += most) {
      const x = places[3 * point]!,
        y = places[3 * point + 1]!,
        z = places[3 * point + 2]!;
      const gx = x < x0 ? x0 - x : x > x1 ? x - x1 : 0,
        gy = y < y0 ? y0 - y : y > y1 ? y - y1 : 0,
        gz = z < z0 ? z0 - z : z > z1 ? z - z1 : 0;
      let bound = squares[last]!;
      if (gx * gx + gy * gy + gz * gz < bound) {
        for (let other = first; other < end; ++other) {
          const dx = places[3 * other]! - x,
            dy = places[3 * other + 1]! - y,
            dz = places[3 * other + 2]! - z;
          const square = dx * dx + dy * dy + dz * dz;
          if (square >= bound || other === point) continue;
          this.insert(last, other, square);
          bound = squares[last]!;
        }
      }
      if (bound > farthest) farthest = bound;
    }
    this.farthest = farthest;
  }

  private insert(last: number, other: number, square: number): void {
    const { squares, numbers, most } = this;
    const first = last - most + 1;
    let at = last;
    for (; at > first && squares[at - 1]! > square; --at) {
      squares[at] = squares[at - 1]!;
      numbers[at] = numbers[at - 1]!;
    }
    squares[at] = square;
    numbers[at] = other;
  }
}
