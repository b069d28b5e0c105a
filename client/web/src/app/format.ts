// SPDX-License-Identifier: Apache-2.0
// Formats numbers for people.

/// Formats a count with separators: 50,000.
export function count(value: number): string {
  return Math.round(value).toLocaleString("en");
}

/// Formats bytes, with 1,000 to a kilobyte: 512 B, 8.1 KB, 1.2 MB.
export function bytes(value: number): string {
  if (value < 1000) return `${Math.round(value)} B`;
  if (value < 999_500) return `${(value / 1e3).toFixed(value < 9950 ? 1 : 0)} KB`;
  return `${(value / 1e6).toFixed(value < 9.95e6 ? 1 : 0)} MB`;
}

/// Formats seconds: 0.8 ms, 42 ms, 1.3 s; a dash for null.
export function seconds(value: number | null): string {
  if (value === null) return "–";
  if (value >= 0.9995) return `${value.toFixed(1)} s`;
  return `${(1000 * value).toFixed(value < 0.00995 ? 1 : 0)} ms`;
}

/// What a length of 1 in the file is.
export type Unit = "none" | "mm" | "cm" | "m" | "in" | "ft";

const fourDigits = (value: number): string => String(Number(value.toPrecision(4)));

/// Formats a length in the file's units with four significant digits.
export function length(value: number, unit: Unit = "none"): string {
  return fourDigits(value) + (unit === "none" ? "" : `\u00a0${unit}`);
}

/// Formats an area in squares of the file's units.
export function area(value: number, unit: Unit = "none"): string {
  return fourDigits(value) + (unit === "none" ? "" : `\u00a0${unit}²`);
}

/// Formats an angle in degrees.
export function angle(degrees: number): string {
  return `${degrees.toFixed(1)}°`;
}
