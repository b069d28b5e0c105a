import { describe, expect, it } from "vitest";

import { angle, area, length } from "../../../../client/web/src/app/format";
import { MeasureTool } from "../../../../client/web/src/view/measure_tool";
import { angleAt, areaOf, measure, type Measured, type MeasureKind } from "../../../../client/web/src/view/measures";
import type { Vec } from "../../../../client/web/src/view/types";

const square: Vec[] = [
  [7, 0, 0],
  [7, 2, 0],
  [7, 2, 2],
  [7, 0, 2],
];

describe("measures", () => {
  it("are distances, angles and areas", () => {
    expect(measure("distance", [square[0]!])).toBeNull();
    expect(measure("distance", [square[0]!, square[2]!])).toEqual({ kind: "distance", value: Math.sqrt(8) });
    expect(angleAt(square[0]!, square[1]!, square[2]!)).toBeCloseTo(90, 9);
    expect(angleAt([1, 0, 0], [0, 0, 0], [-1, 1e-9, 0])).toBeCloseTo(180, 5);
    expect(angleAt([0, 0, 0], [0, 0, 0], [1, 0, 0])).toBe(0);
    expect(areaOf(square)).toBeCloseTo(4, 9);
    expect(areaOf([...square].reverse())).toBeCloseTo(4, 9);
    expect(areaOf(square.map(([x, y, z]): Vec => [x + 1e6, y - 1e6, z]))).toBeCloseTo(4, 5);
    expect(areaOf(square.slice(0, 2))).toBe(0);
    expect(measure("area", square.slice(0, 3))).toEqual({ kind: "area", value: 2 });
    // An L, which no fan of triangles from its first corner covers without signs.
    const corner: Vec[] = [[0, 0, 0], [3, 0, 0], [3, 1, 0], [1, 1, 0], [1, 3, 0], [0, 3, 0]]; // prettier-ignore
    expect(areaOf(corner)).toBeCloseTo(5, 9);
  });

  it("are written with the file's unit", () => {
    expect(length(1.23456, "mm")).toBe("1.235\u00a0mm");
    expect(length(1.5)).toBe("1.5");
    expect(area(2, "ft")).toBe("2\u00a0ft²");
    expect(area(2)).toBe("2");
    expect(angle(45)).toBe("45.0°");
  });
});

describe("the tool that measures", () => {
  const results: (Measured | null)[] = [];
  const toolFor = (kind: MeasureKind): MeasureTool => {
    const tool = new MeasureTool((measured) => results.push(measured));
    tool.setKind(kind);
    results.length = 0;
    return tool;
  };
  const nowhere = (): boolean => false;
  const values = (): (number | null)[] => results.map((result) => result?.value ?? null);

  it("needs two clicks for a distance and three for an angle, and begins anew with the next", () => {
    const tool = toolFor("distance");
    for (const point of [...square.slice(0, 2), ...square.slice(2)]) tool.click(point, nowhere);
    expect(values()).toEqual([2, null, 2]);
    const angles = toolFor("angle");
    for (const point of square) angles.click(point, nowhere);
    expect(values().length).toBe(2);
    expect(values()[0]).toBeCloseTo(90, 9);
    expect(values()[1]).toBeNull();
    expect(angles.followsPointer).toBe(true);
  });

  it("goes on with a polygon until it is closed, and closes it in the picture from the third click on", () => {
    const tool = toolFor("area");
    for (const [i, point] of square.entries()) {
      tool.click(point, (other) => other === square[0] && i < 2); // too early to close it
      expect(tool.lines(null).length).toBe(i === 0 ? 1 : i === 1 ? 3 : 2 * (i + 1));
    }
    expect(values()).toEqual([2, 4]);
    expect(tool.followsPointer).toBe(true);
    tool.click(square[0]!, (other) => other === square[0]);
    expect(values()).toEqual([2, 4, 4]);
    expect(tool.followsPointer).toBe(false);
    tool.click(square[1]!, nowhere);
    expect(values()).toEqual([2, 4, 4, null]);
    expect(tool.lines(null).length).toBe(1);
  });

  it("forgets what was clicked for another measure, and takes nothing while it is off", () => {
    const tool = toolFor("distance");
    tool.click(square[0]!, nowhere);
    expect(tool.setKind("angle")).toBe(true);
    expect(tool.lines(null)).toEqual([]);
    expect(tool.setKind("angle")).toBe(false);
    tool.setKind(null);
    expect(tool.click(square[0]!, nowhere)).toBe(false);
  });
});
