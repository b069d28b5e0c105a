// Meshes for tests.

import type { PlainMesh } from "../unit/draco_modules";

/// A cube from -1 to 1: 8 vertices, 12 triangles.
export function cube(): PlainMesh {
  const positions = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((i) => [0, 1, 2].map((k) => 2 * ((i >> k) & 1) - 1));
  const sides = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
  ] as const;
  return { positions, triangles: sides.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]) };
}

/// A torus around the z axis, radii 1 and 0.4, and its normals: columns x rows vertices, twice as many triangles.
export function torus(columns: number, rows: number): PlainMesh & { normals: number[] } {
  const positions: number[] = [];
  const normals: number[] = [];
  const triangles: number[] = [];
  const index = (i: number, j: number) => (i % columns) * rows + (j % rows);
  for (let i = 0; i < columns; ++i) {
    for (let j = 0; j < rows; ++j) {
      const [u, v] = [(2 * Math.PI * i) / columns, (2 * Math.PI * j) / rows];
      const normal = [Math.cos(v) * Math.cos(u), Math.cos(v) * Math.sin(u), Math.sin(v)] as const;
      normals.push(...normal);
      positions.push(Math.cos(u) + 0.4 * normal[0], Math.sin(u) + 0.4 * normal[1], 0.4 * normal[2]);
      triangles.push(index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j), index(i + 1, j + 1), index(i, j + 1));
    }
  }
  return { positions, normals, triangles };
}
