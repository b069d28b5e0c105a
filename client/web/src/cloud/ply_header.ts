// SPDX-License-Identifier: Apache-2.0
// The header of a PLY file. Turk, "The PLY Polygon File Format", 1994.

import { badFile } from "./words";

/// Bytes at the beginning of a file in which its header has to end.
export const headerBytes = 1 << 16;

const typeNames = {
  int8: ["char", "int8"],
  uint8: ["uchar", "uint8"],
  int16: ["short", "int16"],
  uint16: ["ushort", "uint16"],
  int32: ["int", "int32"],
  uint32: ["uint", "uint32"],
  float32: ["float", "float32"],
  float64: ["double", "float64"],
} as const;

/// The type of a number.
export type PlyType = keyof typeof typeNames;

export const plySizes: Record<PlyType, number> = {
  int8: 1,
  uint8: 1,
  int16: 2,
  uint16: 2,
  int32: 4,
  uint32: 4,
  float32: 4,
  float64: 8,
};

/// A number, or a list of numbers before which there is their count.
export interface PlyProperty {
  name: string;
  type: PlyType;
  /// The type of a list's count; null: no list.
  countType: PlyType | null;
}

/// `count` rows of the same properties.
export interface PlyElement {
  name: string;
  /// As the file says.
  count: number;
  properties: PlyProperty[];
}

export interface PlyHeader {
  format: "ascii" | "littleEndian" | "bigEndian";
  elements: PlyElement[];
  /// Where the header ends: the first byte after it, and its number of lines.
  bytes: number;
  lines: number;
}

const formats: Partial<Record<string, PlyHeader["format"]>> = {
  ascii: "ascii",
  binary_little_endian: "littleEndian",
  binary_big_endian: "bigEndian",
};

function typeOf(name: string | undefined, line: number): PlyType {
  const found = Object.entries(typeNames).find(([, names]) => (names as readonly (string | undefined)[]).includes(name));
  if (found === undefined) throw badFile(`line ${line} of the header: there is no type "${name ?? ""}"`);
  return found[0] as PlyType;
}

function countOf(text: string | undefined, line: number): number {
  if (text === undefined || !/^\d{1,15}$/.test(text)) throw badFile(`line ${line} of the header: "${text ?? ""}" is no count`);
  return Number(text);
}

/// Reads the header from a file's first bytes. Throws INVALID_ARGUMENT where these begin with none, or it does not end in them.
export function parsePlyHeader(bytes: Uint8Array): PlyHeader {
  const text = new TextDecoder("latin1").decode(bytes.subarray(0, headerBytes)); // a character a byte
  if (!/^ply\s/.test(text)) throw badFile('a PLY file begins with the line "ply"');
  const end = /(?:\r\n|\n|\r)end_header[ \t]*(?:\r\n|\n|\r(?!\n))/.exec(text);
  if (end === null) throw badFile(`its header has no end in the first ${headerBytes / 1024} KB`);
  const header: PlyHeader = { format: "ascii", elements: [], bytes: end.index + end[0].length, lines: 0 };
  let format: PlyHeader["format"] | undefined;
  const lines = text.slice(0, end.index).split(/\r\n|\n|\r/);
  lines.forEach((words, i) => {
    const [keyword, ...rest] = words.trim().split(/\s+/);
    const line = i + 1;
    if (keyword === "format") {
      format = formats[rest[0] ?? ""];
      if (format === undefined) throw badFile(`line ${line} of the header: there is no format "${rest[0] ?? ""}"`);
    } else if (keyword === "element") {
      header.elements.push({ name: rest[0] ?? "", count: countOf(rest[1], line), properties: [] });
    } else if (keyword === "property") {
      const element = header.elements.at(-1);
      if (element === undefined) throw badFile(`line ${line} of the header: a property before all elements`);
      const isList = rest[0] === "list";
      const [type, name] = isList ? [rest[2], rest[3]] : [rest[0], rest[1]];
      element.properties.push({
        name: name ?? "",
        type: typeOf(type, line),
        countType: isList ? typeOf(rest[1], line) : null,
      });
    }
  });
  if (format === undefined) throw badFile("its header names no format");
  return { ...header, format, lines: lines.length + 1 };
}

/// Whether a file has a surface, and not points alone.
export const hasFaces = ({ elements }: PlyHeader): boolean =>
  elements.some(({ name, count }) => count > 0 && /^(face|tristrips)$/.test(name));
