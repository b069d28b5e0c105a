import { describe, expect, it } from "vitest";

import { withNormals, type ShadedMesh } from "../../../../client/web/src/stream/corner_normals";
import type { PlainMesh } from "./draco_modules";
import { cube, torus } from "../support/plain_meshes";

const shaded = ({ positions, triangles }: PlainMesh, degrees: number): ShadedMesh =>
  withNormals(Float32Array.from(positions), Uint32Array.from(triangles), degrees);
const at = (values: ArrayLike<number>, i: number) => [values[3 * i]!, values[3 * i + 1]!, values[3 * i + 2]!] as const;
const dot = (a: readonly number[], b: readonly number[]) => a.reduce((sum, value, k) => sum + value * b[k]!, 0);

describe("normals of corners", () => {
  it("are those of the sides where the edges of a cube are creases", () => {
    const mesh = shaded(cube(), 40);
    expect(mesh.sources.length).toBe(24);
    mesh.triangles.forEach((vertex, corner) => {
      expect(mesh.sources[vertex]).toBe(cube().triangles[corner]);
      expect(at(mesh.positions, vertex)).toEqual(at(cube().positions, mesh.sources[vertex]!));
      const [largest] = [...at(mesh.normals, vertex)].map(Math.abs).sort((a, b) => b - a);
      expect(largest).toBe(1);
      expect(dot(at(mesh.normals, vertex), at(mesh.positions, vertex))).toBe(1);
    });
  });

  it("are those of the corners where a cube has no creases: by angles, not by triangles", () => {
    const mesh = shaded(cube(), 180);
    expect(mesh.sources.length).toBe(8);
    for (let i = 0; i < 8; ++i) {
      at(mesh.normals, i).forEach((value, k) => expect(value).toBeCloseTo(at(mesh.positions, i)[k]! / Math.sqrt(3), 6));
    }
  });

  it("divide edges of as much as the limit nowhere, and all edges at 0", () => {
    expect(shaded(cube(), 90).sources.length).toBe(8);
    expect(shaded(cube(), 89.9).sources.length).toBe(24);
    expect(shaded(cube(), 0).sources.length).toBe(36);
  });

  it("are within a degree of a torus's, whose vertices stay as they are", () => {
    const surface = torus(120, 60);
    const mesh = shaded(surface, 40);
    expect(mesh.sources.length).toBe(120 * 60);
    mesh.sources.forEach((source, vertex) => {
      expect(dot(at(mesh.normals, vertex), at(surface.normals, source))).toBeGreaterThan(Math.cos(Math.PI / 180));
    });
  });

  it("are not divided by a crease that ends within the surface", () => {
    // A flat fan of 8 triangles around the origin, of which one spoke is bent up.
    const ring = Array.from({ length: 8 }, (_, i) => [Math.cos((i * Math.PI) / 4), Math.sin((i * Math.PI) / 4), i === 0 ? 0.5 : 0]);
    const triangles = ring.flatMap((_, i) => [0, 1 + i, 1 + ((i + 1) % 8)]);
    const mesh = shaded({ positions: [0, 0, 0, ...ring.flat()], triangles }, 40);
    expect(mesh.sources.filter((source) => source === 0).length).toBe(1);
  });

  it("are those of the faces at hand on a border, and of vertices that are used", () => {
    const positions = [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 9, 9, 9];
    const mesh = shaded({ positions, triangles: [0, 1, 2, 0, 2, 3] }, 40);
    expect([...mesh.sources]).toEqual([0, 1, 2, 3]);
    for (let i = 0; i < 4; ++i) expect([...at(mesh.normals, i)]).toEqual([0, 0, 1]);
  });

  it("are finite beside triangles without area", () => {
    const positions = [0, 0, 0, 1, 0, 0, 2, 0, 0, 1, 1, 0];
    const mesh = shaded({ positions, triangles: [0, 1, 2, 0, 2, 3] }, 40);
    expect(mesh.normals.every(Number.isFinite)).toBe(true);
    for (const vertex of mesh.triangles.subarray(3)) expect([...at(mesh.normals, vertex)]).toEqual([0, 0, 1]);
    expect([...shaded({ positions, triangles: [0, 1, 2] }, 40).normals].every((value) => value === 0)).toBe(true);
  });

  it("join nothing over edges of three faces, or of faces turned against each other", () => {
    const positions = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1];
    expect(shaded({ positions, triangles: [0, 1, 2, 1, 0, 3, 0, 1, 4] }, 180).sources.length).toBe(9);
    expect(shaded({ positions, triangles: [0, 1, 2, 0, 1, 3] }, 180).sources.length).toBe(6);
    expect(shaded({ positions, triangles: [0, 1, 2, 1, 0, 3] }, 180).sources.length).toBe(4);
  });
});
