import { describe, expect, it } from "vitest";

import type { DecodedPoints } from "../../../../client/web/src/stream/decoded_points";
import { readHeader } from "../../../../client/web/src/stream/draco/header";
import { DracoLibrary } from "../../../../client/web/src/stream/draco/library";
import { DracoReader } from "../../../../client/web/src/stream/draco/reader";
import { encodedCloud, loadDecoder, type CloudOptions } from "./draco_modules";

const library = new DracoLibrary(loadDecoder);
const reader = new DracoReader();
const radii = Float32Array.from({ length: 256 }, (_, code) => 1 + code / 16);

const usual: CloudOptions = {
  points: 3000,
  positionBits: 11,
  normalBits: 7,
  speed: 5,
  noise: 0.02,
  colours: false,
  others: false,
};

function columns(count: number, colours: boolean): Pick<DecodedPoints, "count" | "positions" | "normals" | "colours"> {
  const bytes = colours ? new Uint8Array(4 * count) : null;
  return { count, positions: new Float32Array(4 * count), normals: new Int8Array(4 * count), colours: bytes };
}

async function readBoth(bytes: Uint8Array) {
  const header = readHeader(bytes);
  const ours = columns(header.points, header.hasColours);
  const theirs = columns(header.points, header.hasColours);
  const understood = reader.read(bytes, header, radii, ours);
  await library.read(bytes, radii, theirs);
  return { understood, ours, theirs };
}

describe("the reader gives what Draco's decoder gives", () => {
  const variants: Partial<CloudOptions>[] = [
    {},
    { points: 1 },
    { points: 1024 },
    { points: 1025 },
    { points: 40_000 },
    { colours: true },
    { positionBits: 1, normalBits: 2 },
    { positionBits: 16, normalBits: 10 },
    { positionBits: 24, noise: 3 }, // symbols with tags
    { positionBits: 27, noise: 3, normalBits: 15 },
    { positionBits: 14, noise: 3 }, // frequencies of 2^20
    { noise: 0 },
    { speed: 0 },
    { speed: 9 },
    { speed: 10, points: 100 },
  ];
  for (const variant of variants) {
    it(JSON.stringify(variant), async () => {
      const { understood, ours, theirs } = await readBoth(await encodedCloud({ ...usual, ...variant }));
      expect(understood).toBe(true);
      expect(ours.positions).toEqual(theirs.positions);
      expect(ours.colours).toEqual(theirs.colours);
      const apart = ours.normals.map((value, i) => Math.abs(value - theirs.normals[i]!)); // they round to floats in between
      expect(apart.every((step) => step <= 1)).toBe(true);
      expect(apart.filter((step) => step > 0).length).toBeLessThanOrEqual(ours.count / 1000);
    });
  }
});

describe("other data", () => {
  it("is left to Draco's decoder", async () => {
    const { understood, ours, theirs } = await readBoth(await encodedCloud({ ...usual, others: true }));
    expect(understood).toBe(false);
    expect(ours.positions.every((value) => value === 0)).toBe(true);
    expect(theirs.positions.some((value) => value !== 0)).toBe(true);
  });

  it.each([16, 24])("with normals of %i bits is left to it, too", async (normalBits) => {
    const options = { ...usual, positionBits: 27, noise: 3, normalBits };
    const { understood, ours, theirs } = await readBoth(await encodedCloud(options));
    expect(understood).toBe(false);
    expect([...ours.positions, ...ours.normals].every((value) => value === 0)).toBe(true);
    for (let axis = 0; axis < 3; ++axis) expect((theirs.positions[axis]! + 3) / 10).toBeCloseTo(theirs.normals[axis]! / 127, 1);
  });

  it("is refused where an attribute of a block is lacking or of another type", async () => {
    const bytes = await encodedCloud(usual);
    const kindOfRadii = readHeader(bytes).size - 5;
    expect(bytes[kindOfRadii]).toBe(4);
    const changed = bytes.slice();
    changed[kindOfRadii] = 3;
    expect(() => readHeader(changed)).toThrow(/lacks an attribute/);
    changed[kindOfRadii] = 4;
    changed[kindOfRadii + 1] = 1;
    expect(() => readHeader(changed)).toThrow(/another type/);
  });

  it("with any byte changed is refused, or gives finite positions, and takes no time", async () => {
    const bytes = await encodedCloud({ ...usual, points: 200, colours: true });
    let refused = 0;
    for (let i = 0; i < bytes.length; ++i) {
      for (const change of [1, 0x80, 0xff]) {
        const changed = bytes.slice();
        changed[i]! ^= change;
        try {
          const header = readHeader(changed);
          const to = columns(header.points, header.hasColours);
          if (reader.read(changed, header, radii, to)) expect(to.positions.every(Number.isFinite)).toBe(true);
        } catch (thrown) {
          expect(String(thrown)).toMatch(/bad points/);
          ++refused;
        }
      }
    }
    expect(refused).toBeGreaterThan(bytes.length / 10);
  });

  it("that is cut off anywhere is refused", async () => {
    const bytes = await encodedCloud({ ...usual, points: 200 });
    for (let length = 0; length < bytes.length; ++length) {
      expect(() => {
        const cut = bytes.subarray(0, length);
        const header = readHeader(cut);
        reader.read(cut, header, radii, columns(header.points, false));
      }).toThrow(/bad points/);
    }
  });
});
