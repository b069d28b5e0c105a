import { describe, expect, it } from "vitest";

import { passing, turned } from "../../../../../client/web/src/app/film/camera_path";
import type { CameraState, Vec } from "../../../../../client/web/src/view";
import { distance, dot, length, subtract } from "../../../../../client/web/src/view/vector";

const camera: CameraState = { eye: [3, 2, 5], target: [1, 0, 0], up: [0, 1, 0], fov: 30 };

const expectClose = (a: Vec, b: Vec): void => {
  for (const k of [0, 1, 2]) expect(a[k]).toBeCloseTo(b[k]!, 9);
};

describe("a turn", () => {
  it("begins and ends where the camera is, and goes right around", () => {
    expectClose(turned(camera, 0).eye, camera.eye);
    expectClose(turned(camera, 1).eye, camera.eye);
    expectClose(turned(camera, 0.5).eye, [-1, 2, -5]);
    expect(turned(camera, 0.25).eye[0]).toBeGreaterThan(camera.target[0]); // what was in front is seen from the right
  });

  it("keeps height and distance, and the rest of the camera", () => {
    for (let i = 0; i < 30; ++i) {
      const at = turned(camera, i / 30);
      expect(distance(at.eye, at.target)).toBeCloseTo(distance(camera.eye, camera.target), 9);
      expect(dot(at.eye, camera.up)).toBeCloseTo(dot(camera.eye, camera.up), 9);
      expect({ ...at, eye: null }).toEqual({ ...camera, eye: null });
    }
  });
});

describe("a way past views", () => {
  const views: CameraState[] = [
    camera,
    { eye: [0, 4, 1], target: [0, 0, 0], up: [0, 1, 0], fov: 50 },
    { eye: [-6, 1, 0], target: [0, 1, 0], up: [0, 0, 1], fov: 20, orthographic: true },
  ];

  it("passes them all, in order", () => {
    expect(passing(views, 0)).toEqual(views[0]);
    expectClose(passing(views, 0.5).eye, views[1]!.eye);
    expect(passing(views, 0.5).fov).toBeCloseTo(50, 9);
    const last = passing(views, 1);
    expectClose(last.eye, views[2]!.eye);
    expectClose(last.target, views[2]!.target);
    expectClose(last.up, views[2]!.up);
    expect(last.orthographic).toBe(true);
  });

  it("has no leaps, and rests at both ends", () => {
    const steps = 1000;
    const moved = Array.from({ length: steps }, (_, i) =>
      length(subtract(passing(views, (i + 1) / steps).eye, passing(views, i / steps).eye)),
    );
    const way = moved.reduce((sum, step) => sum + step, 0);
    expect(Math.max(...moved)).toBeLessThan((4 * way) / steps);
    expect(moved[0]).toBeLessThan((0.1 * way) / steps);
    expect(moved.at(-1)).toBeLessThan((0.1 * way) / steps);
  });

  it("has a usable camera everywhere", () => {
    for (let i = 0; i <= 100; ++i) {
      const { eye, target, up, fov } = passing(views, i / 100);
      expect(distance(eye, target)).toBeGreaterThan(0.5);
      expect(length(up)).toBeCloseTo(1, 9);
      expect(fov).toBeGreaterThanOrEqual(20);
      expect(fov).toBeLessThanOrEqual(50);
    }
  });
});
