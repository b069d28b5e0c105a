import { describe, expect, it } from "vitest";

import { moved } from "../../../../client/web/src/app/panel_access";

const points = { min: 1000, max: 1_000_000, step: 1000 };

describe("a slider under keys", () => {
  it("goes by steps, with shift and by pages by ten of them, and to its ends", () => {
    expect(moved("ArrowRight", false, 5000, points)).toBe(6000);
    expect(moved("ArrowUp", true, 5000, points)).toBe(15_000);
    expect(moved("ArrowLeft", false, 5000, points)).toBe(4000);
    expect(moved("PageDown", false, 15_000, points)).toBe(5000);
    expect(moved("Home", false, 5000, points)).toBe(1000);
    expect(moved("End", false, 5000, points)).toBe(1_000_000);
  });

  it("stays within its range, and on its steps", () => {
    expect(moved("ArrowLeft", false, 1000, points)).toBe(1000);
    expect(moved("PageUp", false, 999_000, points)).toBe(1_000_000);
    expect(moved("ArrowRight", false, 5400, points)).toBe(6000);
    expect(moved("ArrowRight", false, 0.7, { min: 0.2, max: 3, step: 0.1 })).toBe(0.8);
  });

  it("leaves other keys alone", () => {
    for (const key of ["Tab", "a", "Escape", "Enter"]) expect(moved(key, false, 5000, points)).toBeNull();
  });
});
