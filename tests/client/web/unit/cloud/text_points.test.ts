import { describe, expect, it } from "vitest";

import { readTextPoints } from "../../../../../client/web/src/cloud/text_points";
import { fileOf, unheard } from "./files";

const read = (...parts: Parameters<typeof fileOf>) => readTextPoints(fileOf(...parts), unheard);
const lines = (...rows: string[]): string => rows.join("\n");

describe("text points", () => {
  it.each([
    ["blanks", "1.5 -2 3e2\n  4\t5  6"],
    ["commas and words", "X,Y,Z\r\n1.5,-2,300\r\n4,5,6\r\n"],
    ["semicolons and comments", "# cloud\n// x y z\n1.5; -2 ;3D2 # first\n\n4;5;6\n"],
    ["a count before them", "\ufeff2\n1.5 -2 300\n4 5 6\n"],
    ["the old ends of lines", "1.5 -2 300\r4 5 6\r"],
  ])("are read with %s", async (_, text) => {
    const raw = await read(text);
    expect(raw.count).toBe(2);
    expect([...raw.positions.subarray(0, 6)]).toEqual([1.5, -2, 300, 4, 5, 6]);
    expect([raw.normals, raw.colours, raw.notices]).toEqual([null, null, []]);
  });

  it("keep all digits of their places", async () => {
    const { positions } = await read("4512345.678901234 0.1 -98765.43210987654321\n.5 5. +7\n");
    expect([...positions.subarray(0, 6)]).toEqual([4512345.678901234, 0.1, Number("-98765.43210987654321"), 0.5, 5, 7]);
  });

  it("take further columns for what they look like", async () => {
    const colours = await read(lines("0 0 0 255 0 9", "1 0 0 0 128 0"));
    expect([...colours.colours!]).toEqual([255, 0, 9, 0, 128, 0]);
    const normals = await read(lines("0 0 0 0 0 1", "1 0 0 0.6 0.8 0"));
    expect([...normals.normals!].map((value) => Math.round(10 * value))).toEqual([0, 0, 10, 6, 8, 0]);
    expect(normals.colours).toBeNull();
    const shares = await read(lines("0 0 0 0.1 0 0.5", "1 0 0 1 1 1"));
    expect([...shares.colours!]).toEqual([26, 0, 128, 255, 255, 255]);
    const pts = await read(lines("2", "0 0 0 -1200 1 2 3", "1 0 0 90 4 5 6"));
    expect([...pts.colours!]).toEqual([1, 2, 3, 4, 5, 6]);
    const both = await read(lines("0 0 0 0 0 1 7 8 9", "1 0 0 0 1 0 1 2 3"));
    expect([...both.normals!, ...both.colours!]).toEqual([0, 0, 1, 0, 1, 0, 7, 8, 9, 1, 2, 3]);
    const turned = await read(lines("0 0 0 7 8 9 0 0 1", "1 0 0 1 2 3 0 1 0"));
    expect([...turned.normals!, ...turned.colours!]).toEqual([0, 0, 1, 0, 1, 0, 7, 8, 9, 1, 2, 3]);
    const grey = await read(lines("0 0 0 10", "0 0 1 20", "0 0 2 30"));
    expect([...grey.colours!]).toEqual([0, 0, 0, 127, 127, 127, 255, 255, 255]);
  });

  it("take columns by their names", async () => {
    const raw = await read(lines('"id","b","g","r","x","y","z"', "17,3,2,1,10,20,30", "18,6,5,4,11,21,31"));
    expect([...raw.positions.subarray(0, 6)]).toEqual([10, 20, 30, 11, 21, 31]);
    expect([...raw.colours!]).toEqual([1, 2, 3, 4, 5, 6]);
  });

  it("leave out what is no point, and say where", async () => {
    const raw = await read(lines("1 2 3", "inf 2 3", "4 5", "oops", "1 1e308 2", "7 8 9"));
    expect(raw.count).toBe(2);
    expect(raw.notices).toEqual([
      '2 lines were left out: line 3, "4 5", is no row of numbers with x, y and z',
      "2 points without a place were left out",
    ]);
  });

  it("are an even part of too many", async () => {
    const text = Array.from({ length: 1000 }, (_, i) => `${i} 0 0 ${i % 256} 0 0\n`).join("");
    const raw = await readTextPoints(fileOf(text), unheard, 100);
    const xs = Array.from({ length: raw.count }, (_, i) => raw.positions[3 * i]!);
    expect(raw.count).toBe(63);
    expect(xs).toEqual(xs.map((_, i) => 16 * i));
    expect([...raw.colours!].filter((_, k) => k % 3 === 0)).toEqual(xs.map((x) => x % 256));
    expect(raw.notices).toEqual(["One of 16 points is shown: 63 of 1,000"]);
  });

  it("are the same wherever blocks of the file end", async () => {
    const row = "123.25 -4.5 6\r\n";
    const raw = await read(row.repeat(600_000)); // two blocks and more
    expect(raw.count).toBe(600_000);
    expect(raw.positions.subarray(0, 3 * raw.count).every((value, i) => value === [123.25, -4.5, 6][i % 3])).toBe(true);
  });

  it.each([
    ["nothing", "\n\n", /no row of numbers/],
    ["words", "this is\nno cloud\nat all\n", /line 2, "no cloud", is no row of numbers/],
    ["two columns", "1 2\n3 4\n", /line 1, "1 2", is no row/],
    ["a line without an end", "x".repeat(70_000), /line 1 is too long/],
    ["more words than points", `1 2 3\n${"what is this\n".repeat(200)}`, /line 2, "what is this", is no row/],
  ])("are refused where there is %s", async (_, text, message) => {
    await expect(read(text)).rejects.toThrow(message);
  });

  it("are not made of other files' bytes", async () => {
    let state = 7;
    const junk = Uint8Array.from({ length: 1 << 20 }, () => (state = (Math.imul(state, 1103515245) + 12345) >>> 0) >>> 24);
    await expect(read(junk)).rejects.toThrow(/line \d+/);
  });
});
