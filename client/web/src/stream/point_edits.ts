// What a delta does to a list of points, checked before anything is changed. The same as client/lib/point_edits.cpp.

import type { PointEdits } from "../gen/curvecast/v1/curvecast_pb";
import { badPoints, mostPoints } from "./decoded_points";

/// Indices in lists, ascending: `removed` in the list as it was, `added` in the list of `size` points that it becomes.
export interface CheckedEdits {
  removed: Uint32Array;
  added: Uint32Array;
  size: number;
}

const rungsPerOctave = 2;
const rungs = 64;

/// Throws where edits do not fit a list of `held` points, or do not belong to `added` new ones.
export function checkEdits(edits: PointEdits, held: number, added: number): CheckedEdits {
  const removed = readIndices(edits.removed, held, "removed");
  const size = held - removed.length + added;
  if (size > mostPoints) throw badPoints(`there would be ${size}`);
  const places = readIndices(edits.added, size, "added");
  if (places.length !== added) throw badPoints(`${places.length} indices for ${added} added points`);
  checkResized(edits, size);
  return { removed, added: places, size };
}

/// Calls `resize` for each step of a disc: the index in the new list, and -1 for one rung larger, 1 for one smaller.
export function forEachResized(edits: PointEdits, resize: (index: number, step: number) => void): void {
  let index = 0;
  for (const code of edits.resized) {
    index += code >>> 1;
    resize(index, (code & 1) === 0 ? -1 : 1);
  }
}

/// The radius `step` rungs below another.
export function movedRadius(radius: number, step: number, largest: number): number {
  const rung = Math.round(rungsPerOctave * Math.log2(largest / radius)) + step;
  return largest * 2 ** (-Math.min(Math.max(rung, 0), rungs - 1) / rungsPerOctave);
}

/// `list` without what is removed, and room for what is added, in `to`; the elements of `places` are left to the caller.
export function splice(list: Uint32Array, { removed, added, size }: CheckedEdits, held: number, to: Uint32Array): void {
  let read = 0;
  let written = 0;
  let gone = 0;
  const keep = (count: number) => {
    while (count > 0) {
      while (gone < removed.length && removed[gone] === read) {
        ++gone;
        ++read;
      }
      const part = Math.min(count, (gone < removed.length ? removed[gone]! : held) - read);
      to.set(list.subarray(read, read + part), written);
      read += part;
      written += part;
      count -= part;
    }
  };
  for (const place of added) {
    keep(place - written);
    ++written;
  }
  keep(size - written);
}

/// The first index, then the differences; ascending, and below `size`.
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
