import { describe, expect, it } from "vitest";

import { readPlyPoints } from "../../../../../client/web/src/cloud/ply_points";
import { fileOf, packed, unheard, type Type } from "./files";

const read = (...parts: Parameters<typeof fileOf>) => readPlyPoints(fileOf(...parts), unheard);
const header = (format: string, ...lines: string[]): string =>
  ["ply", `format ${format} 1.0`, ...lines, "end_header", ""].join("\n");
const places = (...types: Type[]): string[] => ["x", "y", "z"].map((name, i) => `property ${types[i] ?? "float"} ${name}`);

const normals = ["nx", "ny", "nz"].map((name) => `property float ${name}`);
const colours = (type: string): string[] => ["red", "green", "blue"].map((name) => `property ${type} ${name}`);

describe("PLY points", () => {
  it("are read from text, with what else they have", async () => {
    const { count, positions, ...rest } = await read(
      header("ascii", "comment x y z", "element vertex 2", ...colours("uchar"), ...places(), ...normals),
      "255 0 7 1 2 3 0 0 1\r\n\n0 128 0 -1e1 .5 6 0 2 0\n",
    );
    expect(count).toBe(2);
    expect([...positions.subarray(0, 6)]).toEqual([1, 2, 3, -10, 0.5, 6]);
    expect([...rest.normals!]).toEqual([0, 0, 1, 0, 2, 0]);
    expect([...rest.colours!]).toEqual([255, 0, 7, 0, 128, 0]);
    expect(rest.notices).toEqual([]);
  });

  it.each([true, false])("are read from bytes of both orders, behind other elements (little endian: %s)", async (isLittle) => {
    const text = header(
      isLittle ? "binary_little_endian" : "binary_big_endian",
      "element camera 2",
      "property double focal",
      "element strip 2",
      "property list uchar int indices",
      "property char kind",
      "element vertex 2",
      ...places("double", "int", "short"),
      ...colours("ushort"),
    );
    const before: [Type, number][] = [
      ["double", 1],
      ["double", 2],
      ["uchar", 2],
      ["int", 7],
      ["int", 8],
      ["char", 1],
      ["uchar", 0],
      ["char", 1],
    ];
    const point = (x: number, y: number, z: number, ...rgb: number[]): [Type, number][] => [
      ["double", x],
      ["int", y],
      ["short", z],
      ...rgb.map((value): [Type, number] => ["ushort", value]),
    ];
    const bytes = packed([...before, ...point(0.1, -2, 3, 65_535, 0, 32_768), ...point(4e5, 5, 6, 257, 0, 0)], isLittle);
    const raw = await read(text, bytes);
    expect([...raw.positions.subarray(0, 6)]).toEqual([0.1, -2, 3, 4e5, 5, 6]);
    expect([...raw.colours!]).toEqual([255, 0, 128, 1, 0, 0]);
    expect(raw.normals).toBeNull();
  });

  it("may have lists", async () => {
    const vertex = ["element vertex 2", "property list uchar short near", ...places()];
    const values: [Type, number][] = [
      ["uchar", 1],
      ["short", 9],
      ...[1, 2, 3].map((value): [Type, number] => ["float", value]),
      ["uchar", 0],
      ...[4, 5, 6].map((value): [Type, number] => ["float", value]),
    ];
    const binary = await read(header("binary_little_endian", ...vertex), packed(values));
    const ascii = await read(header("ascii", ...vertex), "1 9 1 2 3\n0 4 5 6");
    for (const { positions } of [binary, ascii]) expect([...positions.subarray(0, 6)]).toEqual([1, 2, 3, 4, 5, 6]);
  });

  it("have colours from 0 to 1, too", async () => {
    const raw = await read(header("ascii", "element vertex 1", ...places(), ...colours("float")), "1 2 3 1 0.5 nan\n");
    expect([...raw.colours!]).toEqual([255, 128, 0]);
  });

  it("are kept as far as the file goes, and without those that are nowhere", async () => {
    const three = packed([1, 2, 3, NaN, 5, 6, 7, 8, 9].map((value) => ["float", value] as const));
    const raw = await read(header("binary_little_endian", "element vertex 999999999999", ...places()), three.subarray(0, 30));
    expect(raw.count).toBe(1);
    expect(raw.notices).toEqual(["The file ends after 2 of 999,999,999,999 points", "1 point without a place was left out"]);
    const text = await read(header("ascii", "element vertex 4", ...places()), "1 2 3\n1 1e308 3\nx\n4 5 6\n");
    expect(text.count).toBe(2);
    expect(text.notices).toEqual(['A line was left out: line 10, "x", is no vertex', "1 point without a place was left out"]);
  });

  it.each([
    ["no header", "plx\n", /begins with the line "ply"/],
    ["a header without an end", "ply\nformat ascii 1.0\n", /no end in the first 64 KB/],
    ["an unknown format", header("binary", "element vertex 1", ...places()), /line 2 of the header: there is no format "binary"/],
    ["an unknown type", header("ascii", "element vertex 1", "property real x"), /line 4 of the header: there is no type "real"/],
    ["a count that is none", header("ascii", "element vertex -1", ...places()), /line 3 of the header: "-1" is no count/],
    ["no z", header("ascii", "element vertex 1", "property float x", "property float y"), /no x, y and z/],
    ["no vertices", header("ascii", "element point 1", ...places()), /no element "vertex"/],
    ["no bytes", header("binary_little_endian", "element vertex 5", ...places()), /ends before the first of its 5 points/],
    [
      "an element that is longer than the file",
      header("binary_little_endian", "element a 900000000000", "property double b", "element vertex 5", ...places()),
      /ends before its points begin/,
    ],
    [
      "words for numbers",
      header("ascii", "element vertex 1", ...places()) + "one two three\n",
      /line 8, "one two three", is no vertex/,
    ],
  ])("are refused with %s", async (_, text, message) => {
    await expect(read(text)).rejects.toThrow(message);
  });
});
