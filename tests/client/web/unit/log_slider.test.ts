import { describe, expect, it } from "vitest";

import { movedByFactors, placeOf, valueAt } from "../../../../client/web/src/app/log_slider";

const points = { min: 1000, max: 1_000_000, step: 100 };
const kilobytes = { min: 4, max: 8192, step: 1 };

describe("a logarithmic slider", () => {
  it("gives each decade as much room, and round values", () => {
    expect(valueAt(0, points)).toBe(1000);
    expect(valueAt(1 / 3, points)).toBe(10_000);
    expect(valueAt(2 / 3, points)).toBe(100_000);
    expect(valueAt(1, points)).toBe(1_000_000);
    expect(valueAt(0.5, points)).toBe(32_000);
    expect(valueAt(-1, points)).toBe(1000);
    expect(valueAt(2, kilobytes)).toBe(8192);
  });

  it("knows where values are", () => {
    for (const place of [0, 0.21, 0.5, 0.83, 1]) expect(placeOf(valueAt(place, points), points)).toBeCloseTo(place, 1);
    expect(placeOf(0, points)).toBe(0);
  });

  it("goes by equal factors under keys, and back the same way", () => {
    expect(movedByFactors("ArrowRight", false, 1000, points)).toBe(1100);
    expect(movedByFactors("ArrowRight", true, 1000, points)).toBe(3200);
    expect(movedByFactors("PageDown", false, 32_000, points)).toBe(10_000);
    expect(movedByFactors("Home", false, 5000, points)).toBe(1000);
    expect(movedByFactors("a", false, 5000, points)).toBeNull();
  });

  it("reaches its ends by steps, whatever these round to", () => {
    for (const steps of [points, kilobytes]) {
      const values = [steps.min];
      while (values.at(-1)! < steps.max && values.length < 100) {
        values.push(movedByFactors("ArrowRight", false, values.at(-1)!, steps)!);
      }
      expect(values.at(-1)).toBe(steps.max);
      expect(movedByFactors("ArrowRight", false, steps.max, steps)).toBe(steps.max);
      let value = steps.max;
      for (let i = 0; i < 100; ++i) value = movedByFactors("ArrowLeft", false, value, steps)!;
      expect(value).toBe(steps.min);
    }
  });
});
