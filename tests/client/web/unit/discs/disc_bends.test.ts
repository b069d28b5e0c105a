import { describe, expect, test } from "vitest";
import { directions, largestBend } from "../../../../../client/web/src/view/discs/disc_bends";
import { findDiscEnds } from "../../../../../client/web/src/view/discs/disc_ends";
import type { Vec } from "../../../../../client/web/src/view/types";
import { ball, columnsOf, type Disc } from "./discs";

/// The bends of each disc, direction by direction.
function bendsOf(discs: readonly Disc[], scale = 1): number[][] {
  const { positions, normals } = columnsOf(discs);
  const { bends } = findDiscEnds(positions, normals, discs.length, scale);
  expect(bends.length).toBe(directions * discs.length);
  return discs.map((_, slot) =>
    Array.from({ length: directions }, (_, k) => {
      const byte = bends[directions * slot + k]!;
      expect(byte).toBeGreaterThan(0);
      return byte === 255 ? Infinity : largestBend * ((byte - 1) / 253) ** 2;
    }),
  );
}

/// A sheet of 21 x 21 discs with the middles at heights.
function sheet(height: (x: number, y: number) => number, normal: (x: number, y: number) => Vec = () => [0, 0, 1]): Disc[] {
  const discs: Disc[] = [];
  for (let i = -10; i <= 10; ++i) {
    for (let j = -10; j <= 10; ++j) {
      const [x, y] = [0.1 * i + 0.03 * (j & 1), 0.1 * j];
      discs.push({ at: [x, y, height(x, y)], normal: normal(x, y), radius: 0.1 });
    }
  }
  return discs;
}
const middle = 10 * 21 + 10;

const unit = ([x, y, z]: Vec): Vec => {
  const size = Math.hypot(x, y, z);
  return [x / size, y / size, z / size];
};

describe("bends of discs", () => {
  test("are their radius over that of a ball, in all directions", () => {
    const discs = ball(2000, 2.5 * Math.sqrt(4 / 2000));
    const { radius } = discs[0]!;
    const all = bendsOf(discs).flat();
    expect(Math.min(...all)).toBeGreaterThan(0.75 * radius);
    expect(Math.max(...all)).toBeLessThan(1.35 * radius);
  });

  test("are for the radii that a point has, whatever they are drawn with", () => {
    const discs = ball(2000, 2.5 * Math.sqrt(4 / 2000));
    const [some, more] = [bendsOf(discs), bendsOf(discs, 1.3)];
    discs.forEach((_, i) => some[i]!.forEach((bend, k) => expect(more[i]![k]!).toBeCloseTo(bend, 1)));
  });

  test("are none where a surface is flat, or hollow", () => {
    for (const hollow of [0, 0.3]) {
      const discs = sheet(
        (x, y) => hollow * (x * x + y * y),
        (x, y) => unit([-2 * hollow * x, -2 * hollow * y, 1]),
      );
      expect(Math.max(...bendsOf(discs)[middle]!)).toBeLessThan(0.01);
    }
  });

  test("differ by direction on a cylinder", () => {
    const discs = sheet(
      (x) => Math.sqrt(4 - x * x) - 2,
      (x) => unit([x / 2, 0, Math.sqrt(1 - (x / 2) ** 2)]),
    );
    const bends = bendsOf(discs)[middle]!;
    // The plane of a disc whose normal is z has x for its first direction.
    for (const k of [0, 4]) expect(bends[k]).toBeCloseTo(0.1 / 2, 2);
    for (const k of [2, 6]) expect(bends[k]).toBeLessThan(0.01);
  });

  test("tell that a bump is the last thing before an outline, though its normal does not", () => {
    const discs = sheet((x, y) => (x === 0 && y === 0 ? 0.05 : 0));
    for (const bend of bendsOf(discs)[middle]!) expect(bend).toBeGreaterThan(0.2);
    for (const bend of bendsOf(sheet(() => 0))[middle]!) expect(bend).toBeLessThan(0.01);
  });

  test("are not known towards where nobody is, unless all is flat there, and none for a disc alone", () => {
    const last = 20 * 21 + 10; // of x
    const hollow = sheet(
      (x, y) => 0.3 * (x * x + y * y),
      (x, y) => unit([-0.6 * x, -0.6 * y, 1]),
    );
    expect(bendsOf(hollow)[last]![0]).toBe(Infinity);
    expect(bendsOf(hollow)[last]![4]).toBeLessThan(0.01);
    for (const bend of bendsOf(sheet(() => 0))[last]!) expect(bend).toBeLessThan(0.01);
    for (const bend of bendsOf([{ at: [0, 0, 0], normal: [0, 0, 1], radius: 1 }])[0]!) expect(bend).toBe(0);
  });

  test("stay within their bytes for whatever lies there", () => {
    const same = Array.from({ length: 300 }, (): Disc => ({ at: [1, 2, 3], normal: [0, 1, 0], radius: 0.5 }));
    for (const bend of bendsOf(same).flat()) expect(bend).not.toBeNaN();
    const rough = Array.from({ length: 300 }, (_, i): Disc => {
      const next = (n: number): number => ((Math.imul(i + 1, 2654435761 + 40503 * n) >>> 8) % 1000) / 1000;
      return {
        at: [next(1), next(2), next(3)],
        normal: unit([next(4) - 0.5, next(5) - 0.5, next(6) - 0.45]),
        radius: 0.01 + next(7),
      };
    });
    for (const bend of bendsOf(rough).flat()) expect(bend === Infinity || bend <= largestBend).toBe(true);
  });
});
