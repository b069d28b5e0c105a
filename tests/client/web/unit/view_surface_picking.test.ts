import { describe, expect, it } from "vitest";

import { withNormals } from "../../../../client/web/src/stream/corner_normals";
import type { SurfaceMesh } from "../../../../client/web/src/stream/decoded_surface";
import { pickSurface } from "../../../../client/web/src/view/surface_picking";
import type { Ray, Vec } from "../../../../client/web/src/view/types";
import { cube } from "../support/plain_meshes";

const { positions, triangles } = cube();
const surface: SurfaceMesh = {
  ...withNormals(Float32Array.from(positions), Uint32Array.from(triangles), 40),
  origin: [10, 0, 0], // the cube's middle
  colours: null,
  bytes: 0,
};
const ray = (origin: Vec, direction: Vec = [0, 0, -1]): Ray => ({ origin, direction });

describe("a pick of triangles", () => {
  it("is the nearest place that a ray meets, with the normal there", () => {
    const found = pickSurface(surface, ray([10.25, -0.5, 5]), 0.1, 0.02);
    expect(found).toEqual({ point: [10.25, -0.5, 1], normal: [0, 0, 1], radius: 0.02 });
  });

  it("is none beside the surface, or behind the eye", () => {
    expect(pickSurface(surface, ray([11.01, 0, 5]), 0.1, 0.02)).toBeNull();
    expect(pickSurface(surface, ray([10, 0.3, -5]), 0.1, 0.02)).toBeNull();
  });

  it("leaves out what is too near: the inside is seen then", () => {
    expect(pickSurface(surface, ray([10.2, 0.1, 5]), 4.5, 0.02)).toMatchObject({ point: [10.2, 0.1, -1], normal: [0, 0, -1] });
  });

  it("leaves out what is cut off", () => {
    const half = { normal: [0, 0, 1] as Vec, offset: 0 };
    expect(pickSurface(surface, ray([10.2, 0.1, 5]), 0.1, 0.02, half)).toMatchObject({ point: [10.2, 0.1, -1] });
    expect(pickSurface(surface, ray([10.2, 0.1, 5]), 0.1, 0.02, { normal: [1, 0, 0], offset: 10 })).toBeNull();
  });

  it("meets no gap between triangles", () => {
    for (let i = 0; i < 1000; ++i) {
      const at = -0.99 + (1.98 * i) / 999;
      expect(pickSurface(surface, ray([10 + at, at, 5]), 0.1, 0.02)).not.toBeNull();
    }
  });
});
