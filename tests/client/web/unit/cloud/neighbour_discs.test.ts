import { describe, expect, it } from "vitest";

import { makeNeighbourDiscs } from "../../../../../client/web/src/cloud/neighbour_discs";

/// Evenly spread points of a unit sphere.
function sphere(count: number): Float32Array {
  const places = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) {
    const z = 1 - (2 * i + 1) / count;
    const [r, angle] = [Math.sqrt(1 - z * z), 2.399963 * i];
    places.set([r * Math.cos(angle), r * Math.sin(angle), z], 3 * i);
  }
  return places;
}

const radiiOf = ({ positions }: { positions: Float32Array }): number[] => [...positions.filter((_, i) => i % 4 === 3)];
const repeated = (count: number, ...place: number[]): number[] => Array.from({ length: count }, () => place).flat();

describe("discs by neighbours", () => {
  it("close a sphere, and lie in it", () => {
    const count = 5000;
    const places = sphere(count);
    const before = places.slice();
    const { positions, normals, from } = makeNeighbourDiscs(places, null);
    expect(new Set(from).size).toBe(count);
    const spacing = Math.sqrt((4 * Math.PI) / count);
    for (let i = 0; i < count; ++i) {
      const p = [0, 1, 2].map((axis) => positions[4 * i + axis]!);
      expect(p).toEqual([0, 1, 2].map((axis) => before[3 * from[i]! + axis]!));
      const outwards = p.reduce((sum, value, axis) => sum + (value * normals[4 * i + axis]!) / 127, 0);
      expect(outwards).toBeGreaterThan(0.98);
      expect(positions[4 * i + 3]! / spacing).toBeGreaterThan(0.7);
      expect(positions[4 * i + 3]! / spacing).toBeLessThan(1.6);
    }
  });

  it("find the same neighbours as a search through all points", () => {
    let state = 3;
    const random = (): number => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 32;
    const places = Float32Array.from({ length: 3 * 500 }, () => random() ** 4);
    const { positions } = makeNeighbourDiscs(places.slice(), null);
    const all = Array.from({ length: 500 }, (_, i) => positions.subarray(4 * i, 4 * i + 3));
    const sixth = all.map((p) => all.map((q) => Math.hypot(...[0, 1, 2].map((k) => p[k]! - q[k]!))).sort((a, b) => a - b)[6]!);
    const median = [...sixth].sort((a, b) => a - b)[250]!;
    all.forEach((_, i) => {
      const wanted = Math.min(Math.max(sixth[i]!, 0.05 * median), 5 * median);
      expect(positions[4 * i + 3]! / (0.85 * wanted)).toBeCloseTo(1, 2);
    });
  });

  it("follow each other so that every so many are an even part", () => {
    const { positions } = makeNeighbourDiscs(sphere(8000), null);
    for (const step of [2, 7, 16]) {
      const octants = new Array<number>(8).fill(0);
      for (let i = 0; i < 8000; i += step) {
        const [x, y, z] = [positions[4 * i]!, positions[4 * i + 1]!, positions[4 * i + 2]!];
        octants[(x > 0 ? 1 : 0) + (y > 0 ? 2 : 0) + (z > 0 ? 4 : 0)]! += 1;
      }
      for (const count of octants) expect(count / (1000 / step)).toBeCloseTo(1, 0.9);
    }
  });

  it("take the normals that are given, but for those without a direction", () => {
    const given = Float32Array.from({ length: 300 }, (_, i) => (i < 3 ? 0 : i % 3 === 0 ? 5 : 0));
    const { normals, from } = makeNeighbourDiscs(sphere(100), given);
    from.forEach((number, i) => {
      if (number > 0) expect([...normals.subarray(4 * i, 4 * i + 4)]).toEqual([127, 0, 0, 0]);
      else expect(normals[4 * i + 2]).toBeGreaterThan(100);
    });
  });

  it("face the eye where there is no plane", () => {
    const line = Float32Array.from({ length: 30 }, (_, i) => (i % 3 === 0 ? i : 0));
    expect(makeNeighbourDiscs(line, null).normals.every((value) => value === 0)).toBe(true);
    expect([...makeNeighbourDiscs(Float32Array.of(0, 0, 0, 1, 0, 0), null).normals].every((value) => value === 0)).toBe(true);
  });

  it.each([
    ["one point", [1, 2, 3], 1],
    ["two points", [0, 0, 0, 1, 0, 0], 2],
    ["points that are all the same", repeated(5000, 7, 8, 9), 5000],
    [
      "points that are each there twice",
      Array.from({ length: 200 }, (_, i) => repeated(2, i % 20, Math.floor(i / 20), 0)).flat(),
      400,
    ],
    ["a point far from all others", [...sphere(100), 1e15, 0, 0], 101],
  ])("have radii of some size: %s", (_, places, count) => {
    const radii = radiiOf(makeNeighbourDiscs(Float32Array.from(places), null));
    expect(radii.length).toBe(count);
    expect(radii.every((radius) => radius > 0 && radius < 2.5)).toBe(true);
  });

  it("are the same each time, and tell how far they are", () => {
    const parts: number[] = [];
    const first = makeNeighbourDiscs(sphere(60_000), null, (part) => parts.push(part));
    expect(parts.length).toBeGreaterThan(1);
    expect(parts.every((part, i) => part <= 1 && part > (parts[i - 1] ?? 0))).toBe(true);
    const again = makeNeighbourDiscs(sphere(60_000), null);
    for (const column of ["positions", "normals", "from"] as const)
      expect(first[column].every((value, i) => value === again[column][i])).toBe(true);
  });
});
