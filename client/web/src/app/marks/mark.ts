// SPDX-License-Identifier: Apache-2.0
// Annotations: numbered places of the surface, each with a short text.

import type { Vec } from "../../view";

/// An annotation. Its number is its place in the list, from 1.
export interface Mark {
  place: Vec;
  text: string;
}

/// The most annotations; the address has to hold them.
export const maxMarks = 20;
/// The most characters of a text: code points.
export const maxText = 80;

/// Returns a text as an annotation may have it: in one line, and not too long.
export function cleanText(text: string): string {
  const line = text.replace(/[\p{Cc}\p{Cf}\p{Zl}\p{Zp}\s]+/gu, " ").trim();
  return Array.from(line).slice(0, maxText).join("").trim();
}

/// Writes an annotation for the address. `short` writes a coordinate.
export function writeMark({ place, text }: Mark, short: (value: number) => string): string {
  return [...place.map(short), text].join(",");
}

/// Reads what writeMark() has written; null for what it cannot have written.
export function readMark(written: string): Mark | null {
  const parts = /^([^,]+),([^,]+),([^,]+),(.*)$/s.exec(written);
  if (parts === null) return null;
  const place = parts.slice(1, 4).map((part) => (part.trim() === "" ? NaN : Number(part))) as Vec;
  return place.every(Number.isFinite) ? { place, text: cleanText(parts[4]!) } : null;
}
