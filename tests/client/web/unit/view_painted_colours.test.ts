import { describe, expect, test } from "vitest";

import { colourScale } from "../../../../client/web/src/view/colouring";
import { paintPoints } from "../../../../client/web/src/view/painted_colours";
import type { PaintDab } from "../../../../client/web/src/view/types";
import { StreamedPoints } from "../../../../client/web/src/stream/point_store";

const clay = [0xd2, 0xb7, 0x9f];

/// Points at 0, 1, 2 ... on the x axis, far from 0 as coordinates of maps are.
function row(count: number, hasColours = false): StreamedPoints {
  const positions = Float32Array.from({ length: 4 * count }, (_, i) => [i / 4, 0, 0, 0.5][i % 4]!);
  const store = new StreamedPoints();
  store.replace([
    {
      count,
      origin: [1e6, 0, 0],
      positions,
      normals: new Int8Array(4 * count).fill(127),
      colours: hasColours ? new Uint8Array(4 * count).fill(100) : null,
      curvatures: null,
      ranks: null,
      directions: null,
      scalars: [],
    },
  ]);
  return store;
}

const dab = (x: number, radius: number, factor: number): PaintDab => ({ centre: [1e6 + x, 0, 0], radius, factor });

function painted(store: StreamedPoints, dabs: readonly PaintDab[]): number[][] {
  const into = new Uint8Array(store.positions.length);
  paintPoints(store, dabs, into, [0, store.slots]);
  return Array.from({ length: store.slots }, (_, i) => [...into.subarray(4 * i, 4 * i + 3)]);
}

describe("paint", () => {
  test("shows within its balls, and nowhere else", () => {
    const colours = painted(row(6), [dab(2, 1.2, 8)]);
    expect(colours.map((colour) => String(colour) !== String(clay))).toEqual([false, true, true, true, false, false]);
  });

  test("is warm where points become denser, cold where they become fewer, and more of it for more", () => {
    const [, more, most, fewer] = painted(row(4), [dab(1, 0.1, 2), dab(2, 0.1, 64), dab(3, 0.1, 0)]) as [number[], ...number[][]];
    const warmth = (colour: number[]): number => colour[0]! - colour[2]!;
    expect(warmth(more!)).toBeGreaterThan(warmth(clay));
    expect(warmth(most!)).toBeGreaterThan(warmth(more!));
    expect(warmth(fewer!)).toBeLessThan(0);
  });

  test("that came last is on top, also where there are many dabs, and what is rubbed out is gone", () => {
    const many = Array.from({ length: 100 }, (_, i) => dab(i % 3, 0.4, 8));
    expect(painted(row(3), [...many, dab(1, 0.4, 1)])[1]).toEqual(clay);
    expect(painted(row(3), [dab(1, 0.4, 1), ...many])[1]).not.toEqual(clay);
  });

  test("lies over the colours of the surface", () => {
    const colours = painted(row(2, true), [dab(1, 0.1, 8)]);
    expect(colours[0]).toEqual([100, 100, 100]);
    expect(colours[1]![0]).toBeGreaterThan(120);
  });
});

test("a surface without colours of its own is clay, also where it is painted", () => {
  expect(colourScale(row(2), "colour").kind).toBe(0);
  expect(colourScale(row(2, true), "colour")).toMatchObject({ kind: 1, column: "colours" });
  expect(colourScale(row(2), "colour", true)).toMatchObject({ column: "painted", isClay: true });
  expect(colourScale(row(2, true), "colour", true)).toMatchObject({ column: "painted", isClay: false });
  expect(colourScale(row(2), "density", true).column).toBeNull();
});
