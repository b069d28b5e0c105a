// SPDX-License-Identifier: Apache-2.0
// What the columns of a text file of points are.

import { bytesOf, columnsOf, greysOf, type PointSink, type RawPoints } from "./raw_points";

/// The columns that a line of names gives: of the place, and of what else is known, each by its number in the line.
export interface NamedColumns {
  place: readonly [number, number, number];
  /// Columns of 3 each; null: there are none.
  normals: readonly number[] | null;
  colours: readonly number[] | null;
  intensity: number | null;
}

const names = {
  place: [/^x$|^(pos|coord)?_?x$|^easting$/, /^(pos|coord)?_?y$|^northing$/, /^(pos|coord)?_?z$|^(height|elevation)$/],
  normals: [/^n_?x$|^normal_?x$/, /^n_?y$|^normal_?y$/, /^n_?z$|^normal_?z$/],
  colours: [/^r(ed)?$/, /^g(reen)?$/, /^b(lue)?$/],
  intensity: [/^i(ntensity)?$|^(scalar_)?intensity$/],
} as const;

/// Reads the words of a line of names. Returns null where they do not name x, y and z.
export function namedColumns(line: string): NamedColumns | null {
  const words = line
    .replace(/^\s*(#|\/\/)/, "")
    .replaceAll('"', "")
    .split(/[\s,;]+/)
    .filter((word) => word !== "")
    .map((word) => word.toLowerCase());
  const find = (patterns: readonly RegExp[]): number[] | null => {
    const found = patterns.map((pattern) => words.findIndex((word) => pattern.test(word)));
    return found.every((column) => column >= 0) ? found : null;
  };
  const place = find(names.place);
  if (place === null) return null;
  return {
    place: [place[0]!, place[1]!, place[2]!],
    normals: find(names.normals),
    colours: find(names.colours),
    intensity: find(names.intensity)?.[0] ?? null,
  };
}

type Attributes = Pick<RawPoints, "normals" | "colours">;

/// Makes normals and colours of the columns that names give, which are the extras of a sink, in the order of columnsWanted().
export function namedAttributes(sink: PointSink, { normals, colours, intensity }: NamedColumns): Attributes {
  const coloursAt = normals === null ? 0 : 3;
  const intensityAt = coloursAt + (colours === null ? 0 : 3);
  return {
    normals: normals === null ? null : columnsOf(sink, 0, 3),
    colours:
      colours !== null
        ? coloursOf(columnsOf(sink, coloursAt, 3))
        : intensity === null
          ? null
          : greysOf(columnsOf(sink, intensityAt, 1)),
  };
}

/// Returns the columns of a line that are to be kept.
export const columnsWanted = ({ normals, colours, intensity }: NamedColumns): number[] => [
  ...(normals ?? []),
  ...(colours ?? []),
  ...(intensity === null ? [] : [intensity]),
];

/// Takes normals and colours from columns without names, by what is in them: colours are whole numbers of 0 to 255, normals about as long
/// as 1. One column, or one before colours, is an intensity; three that are neither, from 0 to 1, are colours.
export function guessedAttributes(sink: PointSink): Attributes {
  const { width } = sink;
  const triples = Array.from({ length: Math.max(0, width - 2) }, (_, first) => first);
  // After four columns: x, y, z, intensity, red, green, blue, unless it is the other way round.
  const order = width === 4 ? [1, 0] : triples;
  const normalsAt = triples.find((first) => isUnit(sink, first)) ?? null;
  const isFree = (first: number): boolean => normalsAt === null || Math.abs(first - normalsAt) >= 3;
  const coloursAt = order.find((first) => isFree(first) && valuesAre(sink, first, 3, isByte)) ?? null;
  const normals = normalsAt === null ? null : columnsOf(sink, normalsAt, 3);
  if (coloursAt !== null) return { normals, colours: bytesOf(columnsOf(sink, coloursAt, 3), 255) };
  if (normalsAt === null && width === 3 && valuesAre(sink, 0, 3, (value) => value >= 0 && value <= 1))
    return { normals, colours: bytesOf(columnsOf(sink, 0, 3), 1) };
  const hasIntensity = width > 0 && width !== 3 && normalsAt !== 0;
  return { normals, colours: hasIntensity ? greysOf(columnsOf(sink, 0, 1)) : null };
}

const coloursOf = (values: Float32Array): Uint8Array => {
  const most = values.reduce((largest, value) => Math.max(largest, value || 0), 0);
  return bytesOf(values, most <= 1 ? 1 : most <= 255 ? 255 : 65_535);
};

const isByte = (value: number): boolean => value >= 0 && value <= 255 && Number.isInteger(value);

/// Whether all values of `size` columns are what `is` says.
function valuesAre({ extras, width, count }: PointSink, first: number, size: number, is: (value: number) => boolean): boolean {
  for (let i = 0; i < count; ++i) for (let k = 0; k < size; ++k) if (!is(extras[width * i + first + k]!)) return false;
  return count > 0;
}

/// Whether nearly all points have three values there whose squares sum to about 1.
function isUnit({ extras, width, count }: PointSink, first: number): boolean {
  let units = 0;
  for (let i = 0; i < count; ++i) {
    const at = width * i + first;
    const length = Math.hypot(extras[at]!, extras[at + 1]!, extras[at + 2]!);
    if (length > 0.9 && length < 1.1) units += 1;
  }
  return count > 0 && units >= 0.9 * count;
}
