import { describe, expect, it } from "vitest";

import { DrawingBudget } from "../../../../client/web/src/app/drawing_budget";

const frame = 100; // ms

/// The points after so many pictures on a machine that takes `base` ms for a picture, and `each` ms for a point.
function after(pictures: number, base: number, each: number, budget = new DrawingBudget()): number[] {
  return Array.from({ length: pictures }, () => {
    budget.note(budget.mostPoints, base + each * budget.mostPoints, frame);
    return budget.mostPoints;
  });
}

describe("points that are bounded by the time to draw them", () => {
  it("are as many as the server gives where drawing is fast", () => {
    expect(after(3, 5, 1e-5)).toEqual([200_000, 200_000, 200_000]);
  });

  it("come to rest where a still picture takes about three frames", () => {
    const [first, ...rest] = after(20, 50, 0.01);
    expect(first).toBeLessThan(60_000);
    const last = rest.at(-1)!;
    expect(rest.slice(3).every((points) => points === last)).toBe(true);
    expect(50 + 0.01 * last).toBeGreaterThan(frame);
    expect(50 + 0.01 * last).toBeLessThan(4 * frame);
  });

  it("are never fewer than some, and more again when drawing is fast again", () => {
    const budget = new DrawingBudget();
    expect(after(5, 5000, 0.01, budget).at(-1)).toBe(5000);
    expect(after(20, 5, 1e-5, budget).at(-1)).toBe(200_000);
  });

  it("do not grow while there are fewer than they may be", () => {
    const budget = new DrawingBudget();
    budget.note(200_000, 1000, frame);
    const bound = budget.mostPoints;
    budget.note(1000, 10, frame);
    expect(budget.mostPoints).toBe(bound);
  });
});
