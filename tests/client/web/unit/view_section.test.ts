import { describe, expect, it } from "vitest";

import { pick } from "../../../../client/web/src/view/picking";
import { localSection, sectionOf } from "../../../../client/web/src/view/section";
import type { Section, Vec } from "../../../../client/web/src/view/types";
import { dot } from "../../../../client/web/src/view/vector";
import { StreamedPoints } from "../../../../client/web/src/stream/point_store";

const bounds = { min: [10, -2, 0] as Vec, max: [14, 2, 1] as Vec };
const stays = ({ normal, offset }: Section, place: Vec): boolean => dot(normal, place) <= offset;

describe("a plane that cuts a surface open", () => {
  it("stands where it is told, and leaves the one half or the other", () => {
    const low = sectionOf("x", 0.25, false, bounds);
    expect([10.9, 11.1].map((x) => stays(low, [x, 0, 0]))).toEqual([true, false]);
    const high = sectionOf("x", 0.25, true, bounds);
    expect([12.9, 13.1].map((x) => stays(high, [x, 0, 0]))).toEqual([false, true]);
  });

  it("leaves all of the box, or nothing of it", () => {
    for (const axis of ["x", "y", "z"] as const) {
      for (const isOther of [false, true]) {
        for (const corner of [bounds.min, bounds.max]) expect(stays(sectionOf(axis, 1, isOther, bounds), corner)).toBe(true);
        expect(stays(sectionOf(axis, 0, isOther, bounds), [12, 0, 0.5])).toBe(false);
      }
    }
  });

  it("is the same for positions relative to an origin", () => {
    const section = sectionOf("x", 0.25, false, bounds);
    const [x, y, z, offset] = localSection(section, [10, 5, 5]);
    expect(dot([x, y, z], [1, 0, 0])).toBeCloseTo(offset, 12);
    expect(localSection(null, [10, 5, 5])).toEqual([0, 0, 0, 1]);
  });
});

it("what is cut off is not picked, but what is behind it", () => {
  const store = new StreamedPoints();
  const positions = Float32Array.from([0, 0, 0, 0.5, 0, 0, -3, 0.5]);
  const normals = Int8Array.from([0, 0, 127, 0, 0, 0, 127, 0]);
  const none = { colours: null, curvatures: null, ranks: null, directions: null, scalars: [] };
  store.replace([{ count: 2, origin: [0, 0, 100], positions, normals, ...none }]);
  const ray = { origin: [0, 0, 110] as Vec, direction: [0, 0, -1] as Vec };
  expect(pick(store, ray, 0.1, 0.01)?.point[2]).toBeCloseTo(100, 6);
  expect(pick(store, ray, 0.1, 0.01, 1, { normal: [0, 0, 1], offset: 98 })?.point[2]).toBeCloseTo(97, 6);
  expect(pick(store, ray, 0.1, 0.01, 1, { normal: [0, 0, 1], offset: 96 })).toBeNull();
});
