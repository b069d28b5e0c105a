import { describe, expect, test } from "vitest";
import type { PointStore } from "../../../../client/web/src/stream/point_store";
import { pick } from "../../../../client/web/src/view/picking";
import { colourScale } from "../../../../client/web/src/view/colouring";
import { makeColourMap, mapSize } from "../../../../client/web/src/view/colour_maps";
import type { Vec } from "../../../../client/web/src/view/types";
import { distance, dot, normalise, subtract } from "../../../../client/web/src/view/vector";

const origin: Vec = [100, -20, 7];

/// Evenly spread points of a unit sphere about `origin`, with a free slot after each.
function sphere(count: number): PointStore {
  const positions = new Float32Array(8 * count);
  const normals = new Int8Array(8 * count);
  const radius = 1.4 * Math.sqrt((4 * Math.PI) / count);
  for (let i = 0; i < count; ++i) {
    const z = 1 - (2 * (i + 0.5)) / count;
    const angle = i * Math.PI * (3 - Math.sqrt(5));
    const q = Math.sqrt(1 - z * z);
    const p = [q * Math.cos(angle), q * Math.sin(angle), z];
    positions.set([...p, radius], 8 * i);
    normals.set(
      p.map((c) => Math.round(127 * c)),
      8 * i,
    );
  }
  const takeChanges = () => ({ all: false, ranges: [] });
  return {
    origin,
    count,
    slots: 2 * count,
    positions,
    normals,
    colours: null,
    curvatures: null,
    ranks: null,
    directions: null,
    scalars: [],
    creaseDegrees: 40,
    isSurface: true,
    takeChanges,
  };
}

describe("pick", () => {
  const store = sphere(5000);

  test("finds the near side of a sphere, its normal, and nothing beside it", () => {
    const eye: Vec = [origin[0], origin[1], origin[2] + 4];
    for (const [x, y] of [
      [0, 0],
      [0.3, 0.2],
      [-0.5, 0.6],
    ] as const) {
      const place: Vec = [origin[0] + x, origin[1] + y, origin[2] + Math.sqrt(1 - x * x - y * y)];
      const found = pick(store, { origin: eye, direction: normalise(subtract(place, eye), [0, 0, 1]) }, 0.1, 0.001);
      expect(found).not.toBeNull();
      expect(distance(found!.point, place)).toBeLessThan(0.01);
      expect(dot(found!.normal, subtract(place, origin))).toBeGreaterThan(0.995);
    }
    expect(pick(store, { origin: eye, direction: normalise([1, 0, -1], [0, 0, 1]) }, 0.1, 0.001)).toBeNull();
    expect(pick(store, { origin: eye, direction: [0, 0, 1] }, 0.1, 0.001)).toBeNull();
  });

  test("turns normals of points without an outer side to the eye, and hits those without normals, too", () => {
    const inside = { origin, direction: [1, 0, 0] as Vec };
    expect(pick(store, inside, 0.1, 0.001)!.normal[0]).toBeGreaterThan(0.99);
    expect(pick({ ...store, isSurface: false }, inside, 0.1, 0.001)!.normal[0]).toBeLessThan(-0.99);
    const bare = { ...store, isSurface: false, normals: new Int8Array(store.normals.length) };
    expect(distance(pick(bare, inside, 0.1, 0.001)!.point, [origin[0] + 1, origin[1], origin[2]])).toBeLessThan(0.1);
  });

  test("takes the tolerance of parallel rays for a length, however far away they begin", () => {
    for (const reach of [4, 400]) {
      const ray = { origin: [origin[0] + 1.04, origin[1], origin[2] + reach] as Vec, direction: [0, 0, -1] as Vec };
      expect(pick(store, { ...ray, isParallel: true }, 0.1, 0.03)).toBeNull();
      const found = pick(store, { ...ray, isParallel: true }, 0.1, 0.1);
      expect(Math.abs(found!.point[0] - origin[0] - 1)).toBeLessThan(0.06);
    }
  });

  test("what is nearer than the near plane does not count", () => {
    const eye: Vec = [origin[0], origin[1], origin[2] + 4];
    const found = pick(store, { origin: eye, direction: [0, 0, -1] }, 4, 0.001);
    expect(found!.point[2]).toBeCloseTo(origin[2] - 1, 2);
  });

  test("takes the nearest point within the tolerance where no disc is hit", () => {
    const eye: Vec = [origin[0], origin[1], origin[2] + 4];
    const ray = { origin: eye, direction: normalise([1.1, 0, -4], [0, 0, 1]) };
    expect(pick(store, ray, 0.1, 0.001)).toBeNull();
    expect(pick(store, ray, 0.1, 0.1)).not.toBeNull();
  });

  test("an empty store has nothing", () => {
    const empty: PointStore = { ...store, count: 0, slots: 0 };
    expect(pick(empty, { origin: [0, 0, 0], direction: [0, 0, 1] }, 0.1, 0.1)).toBeNull();
  });
});

describe("colours", () => {
  test("a colouring without its column is shading", () => {
    expect(colourScale(sphere(10), "curvature").kind).toBe(0);
    expect(colourScale(sphere(10), "colour").kind).toBe(0);
  });

  test("one value for all points gives a finite scale", () => {
    const scale = colourScale(sphere(100), "density");
    expect(scale.scale).toBeGreaterThan(0);
    expect(Number.isFinite(scale.offset)).toBe(true);
  });

  test("sequential maps get lighter all the way", () => {
    for (const name of ["sequential", "warm"] as const) {
      const map = makeColourMap(name);
      const light = (i: number): number => 0.2126 * map[4 * i]! + 0.7152 * map[4 * i + 1]! + 0.0722 * map[4 * i + 2]!;
      for (let i = 8; i < mapSize; i += 8) expect(light(i)).toBeGreaterThan(light(i - 8));
    }
  });
});
