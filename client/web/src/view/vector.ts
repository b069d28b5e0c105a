// SPDX-License-Identifier: Apache-2.0
// Vectors as plain triples, in double precision.

import type { Vec } from "./types";

export const add = (a: Vec, b: Vec): Vec => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a: Vec, b: Vec): Vec => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a: Vec, factor: number): Vec => [a[0] * factor, a[1] * factor, a[2] * factor];
/// Returns a + factor * b.
export const along = (a: Vec, b: Vec, factor: number): Vec => [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]];
export const dot = (a: Vec, b: Vec): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vec, b: Vec): Vec => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a: Vec): number => Math.hypot(a[0], a[1], a[2]);
export const distance = (a: Vec, b: Vec): number => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
export const isFinite = (a: Vec): boolean => Number.isFinite(a[0]) && Number.isFinite(a[1]) && Number.isFinite(a[2]);

/// Scales a vector to unit length. Returns `fallback` for a vector without direction.
export function normalise(a: Vec, fallback: Vec): Vec {
  const size = length(a);
  return size > 0 && Number.isFinite(size) ? scale(a, 1 / size) : fallback;
}

/// Turns a vector about an axis of unit length, counter-clockwise seen from its tip; radians.
export function rotate(a: Vec, axis: Vec, angle: number): Vec {
  const c = Math.cos(angle);
  return along(along(scale(a, c), cross(axis, a), Math.sin(angle)), axis, dot(axis, a) * (1 - c));
}

/// Returns a unit vector at a right angle to a unit vector.
export function perpendicular(a: Vec): Vec {
  const other: Vec = Math.abs(a[0]) < 0.7 ? [1, 0, 0] : [0, 1, 0];
  return normalise(cross(a, other), [0, 0, 1]);
}
