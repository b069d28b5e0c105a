// Meshes that the tests make themselves, and those that Debian has.

import { execFileSync } from "node:child_process";
import { existsSync } from "node:fs";
import { join } from "node:path";

import { temporaryFolder } from "./server.mjs";

const library = "/usr/share/doc/libcgal-dev/data.tar.gz"; // of libcgal-demo

/// A mesh of CGAL's examples; null where they are not installed.
export function libraryMesh(name) {
  if (!existsSync(library)) return null;
  const folder = temporaryFolder();
  execFileSync("tar", ["-xzf", library, "-C", folder, `data/meshes/${name}`]);
  return join(folder, "data/meshes", name);
}

/// A bumpy torus around the z axis, radii 1 and 0.45, as an OFF file without colours, or with a colour at each vertex.
export function bumpyTorus(columns = 120, rows = 48, isColoured = false) {
  const lines = [isColoured ? "COFF" : "OFF", `${columns * rows} ${2 * columns * rows} 0`];
  for (let i = 0; i < columns; ++i) {
    for (let j = 0; j < rows; ++j) {
      const u = (2 * Math.PI * i) / columns,
        v = (2 * Math.PI * j) / rows;
      const tube = 0.4 + 0.05 * Math.sin(7 * u) * Math.cos(3 * v);
      const place = [(1 + tube * Math.cos(v)) * Math.cos(u), (1 + tube * Math.cos(v)) * Math.sin(u), tube * Math.sin(v)];
      const colour = isColoured ? [127 + 127 * Math.sin(u), 127 + 127 * Math.cos(u), 127 + 127 * Math.sin(v)].map(Math.round) : [];
      lines.push([...place.map((value) => value.toFixed(6)), ...colour, ...(isColoured ? [255] : [])].join(" "));
    }
  }
  const index = (i, j) => (i % columns) * rows + (j % rows);
  for (let i = 0; i < columns; ++i) {
    for (let j = 0; j < rows; ++j) {
      lines.push(`3 ${index(i, j)} ${index(i + 1, j)} ${index(i + 1, j + 1)}`);
      lines.push(`3 ${index(i, j)} ${index(i + 1, j + 1)} ${index(i, j + 1)}`);
    }
  }
  return Buffer.from(lines.join("\n") + "\n");
}

/// A ball of radius 1 around the origin, as an OFF file.
export function ball(columns = 160, rows = 80) {
  const lines = ["OFF", `${columns * (rows - 1) + 2} ${2 * columns * (rows - 1)} 0`, "0 1 0", "0 -1 0"];
  for (let j = 1; j < rows; ++j) {
    for (let i = 0; i < columns; ++i) {
      const [u, v] = [(2 * Math.PI * i) / columns, (Math.PI * j) / rows];
      lines.push([Math.sin(v) * Math.sin(u), Math.cos(v), Math.sin(v) * Math.cos(u)].map((value) => value.toFixed(6)).join(" "));
    }
  }
  const index = (i, j) => 2 + (j - 1) * columns + (i % columns);
  for (let i = 0; i < columns; ++i) {
    lines.push(`3 0 ${index(i, 1)} ${index(i + 1, 1)}`, `3 1 ${index(i + 1, rows - 1)} ${index(i, rows - 1)}`);
    for (let j = 1; j < rows - 1; ++j) {
      lines.push(
        `3 ${index(i, j)} ${index(i, j + 1)} ${index(i + 1, j + 1)}`,
        `3 ${index(i, j)} ${index(i + 1, j + 1)} ${index(i + 1, j)}`,
      );
    }
  }
  return Buffer.from(lines.join("\n") + "\n");
}

/// side x side tetrahedra that touch nowhere, as an OFF file.
export function tetrahedra(side) {
  const corners = [];
  const faces = [];
  for (let i = 0; i < side * side; ++i) {
    const [x, y] = [2 * (i % side), 2 * Math.floor(i / side)];
    for (const [dx, dy, dz] of [
      [0, 0, 0],
      [1, 0, 0],
      [0, 1, 0],
      [0, 0, 1],
    ])
      corners.push(`${x + dx} ${y + dy} ${dz}`);
    const [a, b, c, d] = [4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3];
    for (const face of [
      [a, c, b],
      [a, b, d],
      [b, c, d],
      [a, d, c],
    ])
      faces.push(`3 ${face.join(" ")}`);
  }
  return Buffer.from([`OFF`, `${corners.length} ${faces.length} 0`, ...corners, ...faces].join("\n") + "\n");
}

/// The corners of a cube from -1 to 1, and its sides, seen from outside counter-clockwise.
export const cubeCorners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [0, 1, 2].map((k) => 2 * ((i >> k) & 1) - 1));
export const cubeSides = [
  [0, 2, 3, 1],
  [4, 5, 7, 6],
  [0, 1, 5, 4],
  [2, 6, 7, 3],
  [0, 4, 6, 2],
  [1, 3, 7, 5],
];

/// This cube as an OFF file.
export function cube() {
  const lines = [
    "OFF",
    "8 6 0",
    ...cubeCorners.map((corner) => corner.join(" ")),
    ...cubeSides.map((side) => `4 ${side.join(" ")}`),
  ];
  return Buffer.from(lines.join("\n") + "\n");
}
