// SPDX-License-Identifier: Apache-2.0
// What is measured between points: distances, angles, areas.

import type { Vec } from "./types";
import { add, cross, distance, dot, length, scale, subtract } from "./vector";

export type MeasureKind = "distance" | "angle" | "area";

/// A result: units, degrees, or square units.
export interface Measured {
  kind: MeasureKind;
  value: number;
}

/// Returns the angle at `b` between the directions to `a` and `c`, in degrees; 0 where one of them is `b`.
export function angleAt(a: Vec, b: Vec, c: Vec): number {
  const [p, q] = [subtract(a, b), subtract(c, b)];
  return (Math.atan2(length(cross(p, q)), dot(p, q)) * 180) / Math.PI;
}

/// Returns the area of a polygon; of one that is not flat, of its largest shadow on a plane.
export function areaOf(points: readonly Vec[]): number {
  const first = points[0] ?? [0, 0, 0];
  let sum: Vec = [0, 0, 0];
  for (let i = 2; i < points.length; ++i) sum = add(sum, cross(subtract(points[i - 1]!, first), subtract(points[i]!, first)));
  return length(scale(sum, 0.5));
}

/// Measures what points give; null where there are too few.
export function measure(kind: MeasureKind, points: readonly Vec[]): Measured | null {
  const [a, b, c] = points;
  if (kind === "distance") return a && b ? { kind, value: distance(a, b) } : null;
  if (!a || !b || !c) return null;
  return { kind, value: kind === "angle" ? angleAt(a, b, c) : areaOf(points) };
}
