// SPDX-License-Identifier: Apache-2.0
// What colours points: the column of the store that has the values, and their scale.

import type { PointStore } from "../stream/point_store";
import type { MapName } from "./colour_maps";
import type { Colouring } from "./types";

/// A column that a colouring needs beside positions and normals: of the store, or "painted", the colours under paint.
type PointColumn = "colours" | "curvatures" | "ranks" | "painted";

/// How the shaders colour points: see their `splatColour`.
export interface ColourScale {
  /// The value of COLOURING in the shaders; 0: one colour for all.
  kind: number;
  column: PointColumn | null;
  map: MapName | null;
  /// The divisor of a value, after `offset` is subtracted.
  scale: number;
  offset: number;
  /// The colours are those of a surface without any: shaded as clay, and not as what is coloured.
  isClay: boolean;
}

const samples = 2048;

/// Returns `value` of about `samples` slots with points, spread over all slots; ascending.
function sortedSample(store: PointStore, value: (slot: number) => number): Float32Array {
  const step = Math.max(1, Math.floor(store.slots / samples));
  const values = new Float32Array(Math.ceil(store.slots / step));
  let count = 0;
  for (let slot = 0; slot < store.slots; slot += step) {
    if (store.positions[4 * slot + 3]! <= 0) continue;
    const v = value(slot);
    if (Number.isFinite(v)) values[count++] = v;
  }
  return values.subarray(0, count).sort();
}

const quantile = (sorted: Float32Array, q: number, none: number): number =>
  sorted.length > 0 ? sorted[Math.round(q * (sorted.length - 1))]! : none;

/// Returns the median radius in units; 0 without points.
export const typicalRadius = (store: PointStore): number =>
  quantile(
    sortedSample(store, (slot) => store.positions[4 * slot + 3]!),
    0.5,
    0,
  );

/// Makes the scale for the points of a store, without regard to extremes. A store without the column that the colouring needs is shaded.
/// `isPainted`: paint shows on the surface's own colours and on clay.
export function colourScale(store: PointStore, colouring: Colouring, isPainted = false): ColourScale {
  const plain: ColourScale = { kind: 0, column: null, map: null, scale: 1, offset: 0, isClay: false };
  const { curvatures, ranks, positions } = store;
  const isOwn = colouring === "colour" && store.colours !== null;
  if (isPainted && (isOwn || colouring === "colour" || colouring === "shading")) {
    return { ...plain, kind: 1, column: "painted", isClay: !isOwn };
  }
  if (isOwn) return { ...plain, kind: 1, column: "colours" };
  if (colouring === "curvature" && curvatures) {
    const sizes = sortedSample(store, (slot) => Math.abs(curvatures[2 * slot]! + curvatures[2 * slot + 1]!) / 2);
    return { ...plain, kind: 2, column: "curvatures", map: "diverging", scale: Math.max(quantile(sizes, 0.7, 1), 1e-20) };
  }
  if (colouring === "rank" && ranks) {
    const sorted = sortedSample(store, (slot) => ranks[slot]!);
    return { ...plain, kind: 3, column: "ranks", map: "sequential", scale: Math.max(quantile(sorted, 0.98, 1), 1) };
  }
  if (colouring === "density") {
    const sorted = sortedSample(store, (slot) => -2 * Math.log2(positions[4 * slot + 3]!));
    const [least, most] = [quantile(sorted, 0.01, 0), quantile(sorted, 0.99, 0)];
    // Radii are on rungs of half an octave: points of an even density should not spread over the whole map.
    const span = Math.max(most - least, 4);
    return { ...plain, kind: 4, map: "warm", scale: span, offset: (least + most - span) / 2 };
  }
  return colouring === "normal" ? { ...plain, kind: 5 } : plain;
}
