import { expect, it } from "vitest";

import { barOf, unitsPerPixel } from "../../../../client/web/src/app/scale_bar";

it("is a bar of a round length that fits", () => {
  for (let perPixel = 1e-9; perPixel < 1e9; perPixel *= 1.37) {
    const { units, pixels } = barOf(perPixel);
    expect(pixels).toBeGreaterThan(120 / 2.51);
    expect(pixels).toBeLessThanOrEqual(120.001);
    expect(units / pixels / perPixel).toBeCloseTo(1, 9);
    expect(["1", "2", "5"]).toContain(units.toExponential(6)[0]);
  }
});

it("is exact where lengths are round, and where they are not quite", () => {
  expect(barOf(1 / 120).units).toBe(1);
  expect(barOf(0.2 / 120).units).toBeCloseTo(0.2, 12);
  expect(barOf(50 / 120)).toEqual({ units: 50, pixels: 120 });
});

it("is for what is at the camera's target", () => {
  const camera = { eye: [0, 0, 5], target: [0, 0, 0], up: [0, 1, 0], fov: 90 } as const;
  expect(unitsPerPixel({ ...camera, eye: [...camera.eye], target: [...camera.target], up: [...camera.up] }, 500)).toBeCloseTo(
    0.02,
    12,
  );
});
