import { describe, expect, it } from "vitest";

import { readLasPoints } from "../../../../../client/web/src/cloud/las_points";
import { fileOf, lasOf, unheard } from "./files";

const read = (file: Blob) => readLasPoints(file, unheard);
const places = [
  { place: [100, -200, 5], intensity: 10, colour: [65_535, 0, 257] },
  { place: [0, 0, 0], intensity: 30, colour: [0, 32_896, 0] },
];

describe("LAS points", () => {
  it.each([0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10])("are read in format %s, with colours or greys", async (format) => {
    const raw = await read(lasOf({ format, minor: format > 5 ? 4 : 2, records: places }));
    expect(raw.count).toBe(2);
    const wanted = [1001, 1998, 3000.05, 1000, 2000, 3000];
    wanted.forEach((value, i) => expect(raw.positions[i]).toBeCloseTo(value, 9));
    const hasColours = [2, 3, 5, 7, 8, 10].includes(format);
    expect([...raw.colours!]).toEqual(hasColours ? [255, 0, 1, 0, 128, 0] : [0, 0, 0, 255, 255, 255]);
    expect(raw.notices).toEqual([]);
  });

  it("may have bytes for colours, longer records, and no colours where there is room for them", async () => {
    const bytes = places.map(({ place }) => ({ place, colour: [255, 16, 0] }));
    expect([...(await read(lasOf({ records: bytes, recordBytes: 50 }))).colours!]).toEqual([255, 16, 0, 255, 16, 0]);
    const black = places.map(({ place, intensity }) => ({ place, intensity }));
    expect([...(await read(lasOf({ records: black }))).colours!]).toEqual([0, 0, 0, 255, 255, 255]);
    expect((await read(lasOf({ records: places.map(({ place }) => ({ place })) }))).colours).toBeNull();
  });

  it("are kept as far as the file goes", async () => {
    const file = lasOf({ records: places, count: 4_000_000_000 });
    const raw = await read(file.slice(0, file.size - 1));
    expect(raw.count).toBe(1);
    expect(raw.notices).toEqual(["The file ends after 1 of 4,000,000,000 points"]);
    expect((await read(lasOf({ minor: 4, format: 6, records: places, count: 2 ** 60 }))).count).toBe(2);
  });

  it.each([
    [
      "that are compressed",
      lasOf({ format: 2 | 128, recordBytes: 26, records: places }),
      /compressed \(LAZ\): uncompress it first/,
    ],
    ["of an unknown format", lasOf({ format: 11, recordBytes: 70, records: places }), /no point format 11 \(byte 104\)/],
    ["that are too short", lasOf({ recordBytes: 25, records: [] }), /have 26 bytes at least, and not 25 \(byte 105\)/],
    ["that begin behind the file", lasOf({ pointsAt: 1e6, records: places }), /begin at byte 1000000 of 279 \(byte 96\)/],
    ["that are not there", lasOf({ records: [], count: 9 }), /ends before the first of its 9 points/],
    ["of other files", fileOf("a".repeat(400)), /begins with "LASF"/],
    ["of hardly any bytes", fileOf("LASF"), /4 bytes, and a LAS header has 227/],
  ])("are refused %s", async (_, file, message) => {
    await expect(read(file)).rejects.toThrow(message);
  });
});
