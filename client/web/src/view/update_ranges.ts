// SPDX-License-Identifier: Apache-2.0
// Decides which parts of an array are worth uploading.

const gap = 96; // slots; uploading so many too many costs about as much as another call

/// Joins pairs [begin, end), ascending and apart, that lie near each other. Returns null where uploading all `slots` costs no more.
export function mergeRanges(ranges: readonly number[], slots: number): number[] | null {
  const merged: number[] = [];
  let covered = 0;
  for (let i = 0; i + 1 < ranges.length; i += 2) {
    const begin = ranges[i]!;
    const end = ranges[i + 1]!;
    const last = merged.length - 1;
    if (last > 0 && begin - merged[last]! <= gap) {
      covered += end - merged[last]!;
      merged[last] = end;
    } else {
      merged.push(begin, end);
      covered += end - begin;
    }
  }
  return covered + gap * (merged.length / 2) < 0.8 * slots ? merged : null;
}
