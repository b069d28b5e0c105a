import { describe, expect, test } from "vitest";

import { cameraAxes, isUsable } from "../../../../client/web/src/view/camera_math";
import { directionOf, firstCamera, lookFrom, withFieldOfView, withUp } from "../../../../client/web/src/view/standard_views";
import type { CameraState, Vec } from "../../../../client/web/src/view/types";
import { distance } from "../../../../client/web/src/view/vector";

const camera: CameraState = { eye: [3, 2, 5], target: [0.5, 0, 0], up: [0, 1, 0], fov: 40 };

function expectNear(a: Vec, b: Vec, digits = 9): void {
  a.forEach((value, k) => expect(value).toBeCloseTo(b[k]!, digits));
}

describe("a view by name", () => {
  test("looks from its side, from as far away as before", () => {
    for (const [up, front, above] of [
      ["y", [0, 0, 1], [0, 1, 0]],
      ["z", [0, -1, 0], [0, 0, 1]],
    ] as const) {
      for (const [view, from] of [
        ["front", front],
        ["side", [1, 0, 0]],
        ["top", above],
      ] as const) {
        const seen = lookFrom(camera, directionOf(view, up), up);
        expectNear(cameraAxes(seen).forward, from.map((value) => -value) as Vec, 1.5);
        expect(distance(seen.eye, seen.target)).toBeCloseTo(distance(camera.eye, camera.target), 9);
        expect(seen.target).toEqual(camera.target);
        expect(isUsable(seen)).toBe(true);
      }
      expectNear(cameraAxes(lookFrom(camera, directionOf("front", up), up)).up, [...above]);
    }
  });

  test("has the right side on the right, and from above the front below", () => {
    for (const up of ["y", "z"] as const) {
      expectNear(cameraAxes(lookFrom(camera, directionOf("front", up), up)).right, [1, 0, 0]);
      const top = cameraAxes(lookFrom(camera, directionOf("top", up), up));
      expectNear(top.right, [1, 0, 0]);
      expectNear(top.up, directionOf("front", up).map((value) => -value || 0) as Vec, 1.5);
    }
  });
});

test("another axis up turns the camera with it, there and back", () => {
  expect(withUp(camera, "y")).toBe(camera);
  const lying = withUp(firstCamera, "z");
  expect(lying.up).toEqual([0, 0, 1]);
  expectNear(lying.eye, [0.55, -1, 0.35]);
  expect(withUp(lying, "z")).toBe(lying);
  expectNear(withUp(lying, "y").eye, firstCamera.eye);
});

test("another angle of view leaves the target as large", () => {
  const wide = withFieldOfView(camera, 80);
  expect(wide.fov).toBe(80);
  const height = ({ eye, target, fov }: CameraState): number => distance(eye, target) * Math.tan((fov * Math.PI) / 360);
  expect(height(wide)).toBeCloseTo(height(camera), 9);
  expectNear(cameraAxes(wide).forward, cameraAxes(camera).forward);
});
