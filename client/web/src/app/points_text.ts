// SPDX-License-Identifier: Apache-2.0
// How many points there are, in words.

import { PointLimit } from "../stream";
import { count } from "./format";

/// Newer servers may have reasons of their own.
const reasons: Partial<Record<number, string>> = {
  [PointLimit.BYTES]: "as many as the bytes hold",
  [PointLimit.DENSITY]: "no more places in view",
  [PointLimit.SERVER]: "the server makes no more",
  [PointLimit.COMING]: "more are coming",
};

/// Says how many points of how many there are and, where that is not all, why: "4,384 of 50,000, no more places in view".
export function pointsText(points: number, last: { wantedPoints: number; limit: number } | null): string {
  if (last === null || points >= last.wantedPoints) return count(points);
  const reason = reasons[last.limit];
  return `${count(points)} of ${count(last.wantedPoints)}${reason === undefined ? "" : `, ${reason}`}`;
}
