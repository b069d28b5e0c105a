import { describe, expect, test } from "vitest";
import { findDiscEnds } from "../../../../../client/web/src/view/discs/disc_ends";
import type { Vec } from "../../../../../client/web/src/view/types";
import { dot, subtract } from "../../../../../client/web/src/view/vector";
import { ball, columnsOf, type Disc } from "./discs";

const step = 0.1;

const disc = (at: Vec, normal: Vec, radius = 0.1): Disc => ({ at, normal, radius });

/// The planes of each disc; null: it has none.
function planesOf(discs: readonly Disc[], scale = 1, creaseDegrees?: number): (Float32Array | null)[] {
  const { positions, normals } = columnsOf(discs);
  const { slots, planes } = findDiscEnds(positions, normals, discs.length, scale, creaseDegrees);
  const found = discs.map((): Float32Array | null => null);
  slots.forEach((slot, i) => (found[slot] = planes.subarray(8 * i, 8 * i + 8)));
  return found;
}

function isDrawn({ at }: Disc, planes: Float32Array | null, place: Vec): boolean {
  const away = subtract(place, at);
  return [0, 4].every((i) => planes === null || dot([planes[i]!, planes[i + 1]!, planes[i + 2]!], away) <= planes[i + 3]!);
}

/// Points on the half planes z = 0, x < 0 and x = 0, z < 0, which meet at a ridge, or z > 0: in a valley.
function bent(isRidge: boolean, radius = 0.1): Disc[] {
  const discs: Disc[] = [];
  for (let i = 0; i < 10; ++i) {
    for (let j = -5; j < 5; ++j) {
      const [away, along] = [(i + 0.5) * step, j * step];
      discs.push(disc([-away, along, 0], [0, 0, 1], radius));
      discs.push(disc([0, along, isRidge ? -away : away], [isRidge ? 1 : -1, 0, 0], radius));
    }
  }
  return discs;
}

describe("discs", () => {
  test.each([true, false])("end at a crease (a ridge: %s)", (isRidge) => {
    const discs = bent(isRidge);
    const outwards = isRidge ? 0.01 : -0.01;
    planesOf(discs).forEach((planes, i) => {
      const { at, normal, radius } = discs[i]!;
      expect(isDrawn(discs[i]!, planes, at)).toBe(true);
      const isFlat = normal[2] > 0.5;
      const away = isFlat ? -at[0] : Math.abs(at[2]);
      expect(planes !== null, `${away} from the crease`).toBe(away < 1.4 * radius);
      if (planes === null) return;
      const beyond: Vec = isFlat ? [0.01, at[1], 0] : [0, at[1], outwards];
      const before: Vec = isFlat ? [-0.01, at[1], 0] : [0, at[1], -outwards];
      expect(isDrawn(discs[i]!, planes, beyond)).toBe(false);
      expect(isDrawn(discs[i]!, planes, before)).toBe(true);
    });
  });

  test("begin at the angle that is asked for", () => {
    const ends = (turn: number, creaseDegrees: number): number => {
      const [cosine, sine] = [Math.cos((turn * Math.PI) / 180), Math.sin((turn * Math.PI) / 180)];
      const discs: Disc[] = [];
      for (let i = 0; i < 10; ++i) {
        for (let j = -5; j < 5; ++j) {
          const [away, along] = [(i + 0.5) * step, j * step];
          discs.push(disc([-away, along, 0], [0, 0, 1]), disc([away * cosine, along, -away * sine], [sine, 0, cosine]));
        }
      }
      return planesOf(discs, 1, creaseDegrees).filter((planes) => planes !== null).length;
    };
    for (const turn of [10, 30, 90]) {
      expect(ends(turn, turn - 2)).toBeGreaterThan(0);
      expect(ends(turn, 0)).toBe(ends(turn, turn - 2));
      expect(ends(turn, turn + 2)).toBe(0);
    }
    expect(ends(90, 180)).toBe(0);
    expect(ends(3, 0)).toBe(0); // normals are rounded
  });

  test("have two lines at a corner", () => {
    const discs: Disc[] = [];
    for (let i = 0; i < 8; ++i) {
      for (let j = 0; j < 8; ++j) {
        const [a, b] = [-(i + 0.5) * step, -(j + 0.5) * step];
        discs.push(disc([a, b, 0], [0, 0, 1]), disc([0, a, b], [1, 0, 0]), disc([b, 0, a], [0, 1, 0]));
      }
    }
    const planes = planesOf(discs)[0]!;
    const isThere = (place: Vec): boolean => isDrawn(discs[0]!, planes, place);
    expect(isThere([0.01, -0.05, 0])).toBe(false);
    expect(isThere([-0.05, 0.01, 0])).toBe(false);
    expect(isThere([-0.01, -0.01, 0])).toBe(true);
  });

  test("of smooth surfaces and thin sheets have no ends", () => {
    const discs = ball(2000, 0.08);
    for (let i = 0; i < 400; ++i) {
      const [x, y] = [5 + step * (i % 20), step * Math.floor(i / 20)];
      discs.push(disc([x, y, 0], [0, 0, 1]), disc([x + 0.03, y, -0.02], [0, 0, -1]));
    }
    expect(planesOf(discs).every((planes) => planes === null)).toBe(true);
  });

  test("end where the other side of a crease has few and large ones", () => {
    const discs: Disc[] = [];
    for (let i = 0; i < 40; ++i) {
      for (let j = 0; j < 40; ++j) discs.push(disc([-(i + 0.5) / 40, j / 40, 0], [0, 0, 1], 1 / 40));
    }
    for (let i = 0; i < 5; ++i) {
      for (let j = 0; j < 5; ++j) discs.push(disc([0, j / 4, -(i + 0.4) / 5], [1, 0, 0], 1 / 5));
    }
    planesOf(discs).forEach((planes, i) => {
      const { at, normal, radius } = discs[i]!;
      const away = normal[2] > 0.5 ? -at[0] : -at[2];
      expect(planes !== null, `${away} from the crease`).toBe(away < 1.4 * radius);
    });
  });

  test("that are drawn larger reach creases that are farther away", () => {
    const count = (scale: number): number => planesOf(bent(true), scale).filter((planes) => planes !== null).length;
    expect(count(2)).toBe(3 * count(1));
    expect(planesOf(bent(true, 0.2)).filter((planes) => planes !== null).length).toBe(count(2));
  });

  test("may be odd", () => {
    expect(planesOf([])).toEqual([]);
    expect(planesOf([disc([1, 2, 3], [0, 0, 1])])).toEqual([null]);
    // At one place, without normals, without size, far away, no numbers.
    const many = Array.from({ length: 50 }, () => disc([1, 2, 3], [0, 0, 1]));
    for (let i = 0; i < 50; ++i) many.push(disc([1, 2, 3], i % 2 === 0 ? [0, 1, 0] : [0, 0, 0], i % 3 === 0 ? 0 : 1e12));
    many.push(disc([1e12, 0, 0], [1, 0, 0]), disc([NaN, Infinity, 0], [1, 0, 0]), disc([1, 2, 3], [1, 0, 0], NaN));
    many.push(disc([1, 2, 3], [1, 0, 0], 1e-40), disc([1, 2, 3], [1, 0, 0], Infinity));
    for (const planes of planesOf(many)) if (planes !== null) expect(planes.some(Number.isNaN)).toBe(false);
  });

  test("in a crowd take no more than their time", () => {
    const crowd = [...ball(20_000, 5), ...bent(true).map(({ at, normal }) => disc([at[0] + 100, at[1], at[2]], normal))];
    const planes = planesOf(crowd);
    expect(planes.slice(20_000).some((each) => each !== null)).toBe(true);
  });
});
