import { describe, expect, test } from "vitest";
import {
  blend,
  cameraAxes,
  clipPlanes,
  fit,
  isUsable,
  mayMove,
  orbit,
  halfHeight,
  rayDirection,
  rayThrough,
  shift,
  zoom,
} from "../../../../client/web/src/view/camera_math";
import type { CameraState, Vec } from "../../../../client/web/src/view/types";
import { cross, distance, dot, length, subtract } from "../../../../client/web/src/view/vector";

const camera: CameraState = { eye: [3, 2, 5], target: [0.5, 0, 0], up: [0, 1, 0], fov: 40 };

/// Where a point is in the picture, from -1 to 1.
function project(state: CameraState, point: Vec, aspect: number): [number, number] {
  const axes = cameraAxes(state);
  const p = subtract(point, state.eye);
  const t = Math.tan((state.fov * Math.PI) / 360) * dot(p, axes.forward);
  return [dot(p, axes.right) / (t * aspect), dot(p, axes.up) / t];
}

function expectSame(a: readonly number[], b: readonly number[]): void {
  a.forEach((value, i) => expect(value).toBeCloseTo(b[i]!, 9));
}

describe("orbit", () => {
  test("keeps the distance to the pivot, and the pivot's place in the picture", () => {
    const pivot: Vec = [1, 0.5, -0.3];
    const turned = orbit(camera, pivot, 0.7, 0.2);
    expect(distance(turned.eye, pivot)).toBeCloseTo(distance(camera.eye, pivot), 9);
    expect(distance(turned.eye, turned.target)).toBeCloseTo(distance(camera.eye, camera.target), 9);
    expectSame(project(orbit(camera, camera.target, 0.7, 0.2), camera.target, 1.5), [0, 0]);
  });

  test("stops before the poles, whichever way and however far", () => {
    for (const pitch of [0.1, -0.1, 10, -10]) {
      let state = camera;
      for (let i = 0; i < 50; ++i) state = orbit(state, state.target, 0.3, pitch);
      expect(isUsable(state)).toBe(true);
      const { right, forward } = cameraAxes(state);
      expect(Math.abs(dot(right, state.up))).toBeLessThan(1e-9);
      expect(length(cross(forward, state.up))).toBeGreaterThan(0.009);
    }
  });

  test("turns there and back", () => {
    const back = orbit(orbit(camera, [0, 0, 0], 0.4, 0), [0, 0, 0], -0.4, 0);
    expectSame([...back.eye, ...back.target], [...camera.eye, ...camera.target]);
  });

  test("ignores what is no number", () => {
    expect(orbit(camera, [0, 0, 0], NaN, 0)).toBe(camera);
    expect(shift(camera, Infinity, 0, 0)).toBe(camera);
    expect(zoom(camera, [0, 0, 0], NaN, 0, 1)).toBe(camera);
  });
});

describe("zoom", () => {
  test("keeps a point where it is in the picture", () => {
    const point: Vec = [0.9, 0.4, 0.7];
    const nearer = zoom(camera, point, 0.3, 1e-3, 100);
    expectSame(project(nearer, point, 1.3), project(camera, point, 1.3));
    expect(distance(nearer.eye, point)).toBeCloseTo(0.3 * distance(camera.eye, point), 9);
  });

  test("stays within its limits for ever", () => {
    let [near, far] = [camera, camera];
    for (let i = 0; i < 500; ++i) {
      near = zoom(near, [0, 0, 0], 0.5, 0.01, 50);
      far = zoom(far, [0, 0, 0], 2, 0.01, 50);
    }
    expect(length(near.eye)).toBeCloseTo(0.01, 9);
    expect(length(far.eye)).toBeCloseTo(50, 6);
    expect(isUsable(near) && isUsable(far)).toBe(true);
  });
});

test("rays go through the points that they are asked for", () => {
  const direction = rayDirection(camera, 1.7, 0.6, -0.4);
  expect(length(direction)).toBeCloseTo(1, 12);
  expectSame(project(camera, [0, 1, 2].map((k) => camera.eye[k]! + 3 * direction[k]!) as Vec, 1.7), [0.6, -0.4]);
});

test("a camera along its up direction still has axes", () => {
  const { right, up, forward } = cameraAxes({ ...camera, eye: [0, 5, 0], target: [0, 0, 0] });
  expect([dot(right, up), dot(up, forward), dot(forward, right)].every((cosine) => Math.abs(cosine) < 5e-13)).toBe(true);
  for (const a of [right, up, forward]) expect(length(a)).toBeCloseTo(1, 12);
});

describe("fit", () => {
  const bounds = { min: [-2, 10, 100] as Vec, max: [3, 11, 104] as Vec };
  const corners = Array.from({ length: 8 }, (_, i) => [0, 1, 2].map((k) => ((i >> k) & 1 ? bounds.max : bounds.min)[k]!) as Vec);

  test("shows the whole box, large, from where the camera stands", () => {
    for (const eye of [camera.eye, [0.6, 9, 0.1], [-30, -4, 2]] as Vec[]) {
      for (const fov of [15, 40, 100]) {
        for (const aspect of [0.4, 1, 2.5]) {
          const from = { ...camera, eye, fov };
          const fitted = fit(from, bounds, aspect);
          expectSame(cameraAxes(fitted).forward, cameraAxes(from).forward);
          const reaches = corners.flatMap((corner) => project(fitted, corner, aspect).map(Math.abs));
          expect(Math.max(...reaches)).toBeLessThan(0.95); // to the very corners, into which the head of a hammer reaches
          expect(Math.max(...reaches)).toBeGreaterThan(0.85);
        }
      }
    }
  });
});

test("clip planes hold the box, from outside and from within", () => {
  const bounds = { min: [-1, -1, -1] as Vec, max: [1, 1, 1] as Vec };
  for (const reach of [1e-3, 0.5, 3, 1000]) {
    const { near, far } = clipPlanes({ ...camera, eye: [0, 0, reach], target: [0, 0, 0] }, bounds);
    expect(near).toBeGreaterThan(0);
    expect(far).toBeGreaterThanOrEqual(reach + Math.sqrt(3));
    expect(near).toBeLessThan(far);
    if (reach > 2) expect(near).toBeLessThanOrEqual(reach - Math.sqrt(3));
  }
});

test("walls nearby are not cut away within the box, wherever the target is", () => {
  const bounds = { min: [-1, -1, -1] as Vec, max: [1, 1, 1] as Vec };
  const { near, far } = clipPlanes({ ...camera, eye: [0, 0, 0.9], target: [0, 0, -30] }, bounds);
  expect(near).toBeLessThan(0.004 * Math.sqrt(3));
  // Depths are n / z below 1, as single floats: what they tell apart at the far plane.
  expect((far * far * 2 ** -24) / near).toBeLessThan(2e-4 * Math.sqrt(3));
});

test("a camera stays near the surface, and comes back where it does not", () => {
  const bounds = { min: [-1, -1, -1] as Vec, max: [1, 1, 1] as Vec };
  const at = (z: number): Vec => [0, 0, z];
  expect(mayMove(at(10), at(60), bounds)).toBe(true);
  expect(mayMove(at(60), at(75), bounds)).toBe(false);
  expect(mayMove(at(90), at(100), bounds)).toBe(false);
  expect(mayMove(at(100), at(90), bounds)).toBe(true);
});

test("blending ends in the second camera and is usable on the way", () => {
  const other: CameraState = { eye: [-3, -2, -5], target: [0, 0, 0], up: [0, 0, 1], fov: 30 };
  expect(blend(camera, other, 1)).toBe(other);
  for (const t of [0, 0.2, 0.5, 0.9]) expect(isUsable(blend(camera, other, t))).toBe(true);
  expectSame(blend(camera, other, 0).eye, camera.eye);
});

describe("an orthographic camera", () => {
  const flat: CameraState = { ...camera, orthographic: true };
  const box = { min: [-1, -2, -3] as Vec, max: [4, 2, 1] as Vec };
  /// Where a point is in the picture, from -1 to 1.
  const place = (state: CameraState, point: Vec, aspect: number): [number, number] => {
    const axes = cameraAxes(state);
    const p = subtract(point, state.target);
    return [dot(p, axes.right) / (halfHeight(state) * aspect), dot(p, axes.up) / halfHeight(state)];
  };

  test("has parallel rays, from before all of the surface, through the places of the picture", () => {
    const { forward } = cameraAxes(flat);
    for (const [x, y] of [
      [0, 0],
      [1, -1],
      [-0.3, 0.7],
    ] as const) {
      const ray = rayThrough(flat, box, 1.5, x, y);
      expect(ray.isParallel).toBe(true);
      expectSame(ray.direction, forward);
      expectSame(place(flat, ray.origin, 1.5), [x, y]);
      for (const corner of [box.min, box.max]) expect(dot(subtract(corner, ray.origin), forward)).toBeGreaterThan(0);
    }
    expect(rayThrough(camera, box, 1.5, 0.2, 0.1)).toEqual({
      origin: camera.eye,
      direction: rayDirection(camera, 1.5, 0.2, 0.1),
    });
  });

  test("zooms to a point wherever it is, also to one in its eye", () => {
    for (const point of [[1, 1, 1], flat.eye, [9, 9, 9]] as Vec[]) {
      const near = zoom(flat, point, 0.5, 1e-3, 1e3);
      expect(halfHeight(near)).toBeCloseTo(0.5 * halfHeight(flat), 9);
      expectSame(place(near, point, 1.2), place(flat, point, 1.2));
    }
    expect(halfHeight(zoom(flat, [0, 0, 0], 1e-9, 2, 10))).toBeCloseTo(2 * Math.tan((20 * Math.PI) / 180), 9);
  });

  test("fits a box into the picture, touching two sides of the margin, and sees all of its depth", () => {
    for (const aspect of [0.5, 1, 3]) {
      const fitted = fit(flat, box, aspect);
      let most = 0;
      for (let i = 0; i < 8; ++i) {
        const corner = [0, 1, 2].map((k) => (i & (1 << k) ? box.max : box.min)[k]!) as Vec;
        most = Math.max(most, ...place(fitted, corner, aspect).map(Math.abs));
        const { near, far } = clipPlanes(fitted, box);
        const depth = dot(subtract(corner, rayThrough(fitted, box, aspect, 0, 0).origin), cameraAxes(fitted).forward);
        expect(depth).toBeGreaterThan(near);
        expect(depth).toBeLessThan(far);
      }
      expect(most).toBeCloseTo(0.92, 9);
    }
  });
});
