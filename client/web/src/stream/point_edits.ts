// SPDX-License-Identifier: Apache-2.0
// What a delta does to a list of points, checked before anything is changed. The C++ and Python clients do the same, and all follow
// tests/client/point_edits.json.

import type { PointEdits } from "../gen/curvecast/v1/curvecast_pb";
import { badPoints } from "./decoded_points";
import { maxPoints, radiusRungs, radiusRungsPerOctave } from "./protocol";

/// Edits as ascending indices: `removed` in the list before, `added` in the list of `size` points after.
export interface CheckedEdits {
  removed: Uint32Array;
  added: Uint32Array;
  size: number;
}

/// Checks edits of a list of `count` points that come with `fresh` new points. Throws DATA_LOSS where the edits do not fit them.
export function checkEdits(edits: PointEdits, count: number, fresh: number): CheckedEdits {
  const removed = readIndices(edits.removed, count, "removed");
  const size = count - removed.length + fresh;
  if (size > maxPoints) throw badPoints(`there would be ${size}`);
  const added = readIndices(edits.added, size, "added");
  if (added.length !== fresh) throw badPoints(`${added.length} indices for ${fresh} added points`);
  checkResized(edits, size);
  return { removed, added, size };
}

/// Calls `resize` for each step of a disc, with the index in the list after, and -1 for one rung larger or 1 for one rung smaller.
export function forEachResized(edits: PointEdits, resize: (index: number, step: number) => void): void {
  let index = 0;
  for (const code of edits.resized) {
    index += code >>> 1;
    resize(index, (code & 1) === 0 ? -1 : 1);
  }
}

/// Returns the radius `step` rungs below `radius`, on the ladder whose first rung is `largest`.
export function movedRadius(radius: number, step: number, largest: number): number {
  const rung = Math.round(radiusRungsPerOctave * Math.log2(largest / radius)) + step;
  return largest * 2 ** (-Math.min(Math.max(rung, 0), radiusRungs - 1) / radiusRungsPerOctave);
}

/// Copies the first `count` elements of `list` to `to`, without those that are removed. Leaves gaps at the indices `added`, for the
/// caller to fill.
export function splice(list: Uint32Array, { removed, added, size }: CheckedEdits, count: number, to: Uint32Array): void {
  let read = 0;
  let written = 0;
  let skipped = 0; // elements of `removed`
  const keep = (left: number) => {
    while (left > 0) {
      while (skipped < removed.length && removed[skipped] === read) {
        ++skipped;
        ++read;
      }
      const part = Math.min(left, (skipped < removed.length ? removed[skipped]! : count) - read);
      to.set(list.subarray(read, read + part), written);
      read += part;
      written += part;
      left -= part;
    }
  };
  for (const index of added) {
    keep(index - written);
    ++written;
  }
  keep(size - written);
}

/// Sums up the first index and the differences. Throws DATA_LOSS where the indices do not ascend, or are not below `size`.
function readIndices(steps: readonly number[], size: number, what: string): Uint32Array {
  const indices = new Uint32Array(steps.length);
  let last = 0;
  steps.forEach((step, i) => {
    if (step === 0 && i > 0) throw badPoints(`${what} holds an index twice`);
    last += step;
    if (last >= size) throw badPoints(`${what} holds index ${last} of ${size}`);
    indices[i] = last;
  });
  return indices;
}

function checkResized(edits: PointEdits, size: number): void {
  if (edits.resized.length === 0) return;
  if (!(edits.radiusMax > 0 && Number.isFinite(edits.radiusMax))) throw badPoints("radius_max is no radius");
  forEachResized(edits, (index) => {
    if (index >= size) throw badPoints(`resized holds index ${index} of ${size}`);
  });
}
