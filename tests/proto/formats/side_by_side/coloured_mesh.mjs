// A mesh as the comparison of viewers wants it: with colours, since some of them have no lights, and of a size for their cameras.

import { readFileSync, writeFileSync } from "node:fs";

const LIGHT = [-0.8, 0.5, -0.33]; // where it comes from; a unit vector
const DARK = [46, 52, 78];
const BRIGHT = [255, 228, 190];

/** Vertices with places and normals, and triangles, of an .obj file as the command writes it. */
function readObj(text) {
  const found = { v: [], vn: [], f: [] };
  for (const line of text.split("\n")) {
    const [kind, ...words] = line.split(" ");
    found[kind]?.push(words.map((word) => parseFloat(word))); // of a//b, a: the normals stand as the vertices do
  }
  return { places: found.v, normals: found.vn, triangles: found.f.map((corners) => corners.map((corner) => corner - 1)) };
}

/** Moves the box's middle to the origin, and makes the box's longest side 2. */
function toUnitSize(places) {
  const bound = (better, from) => [0, 1, 2].map((k) => places.reduce((best, place) => better(best, place[k]), from));
  const [low, high] = [bound(Math.min, Infinity), bound(Math.max, -Infinity)];
  const scale = 2 / Math.max(...low.map((least, k) => high[k] - least));
  return places.map((place) => place.map((value, k) => scale * (value - (low[k] + high[k]) / 2)));
}

/** Makes a .ply file of an .obj file that the command has written: of that size, and in the colours of a light. Returns its area. */
export function makeColoured(obj, ply) {
  const { places, normals, triangles } = readObj(readFileSync(obj, "utf8"));
  const sized = toUnitSize(places);
  const rows = normals.map((normal, i) => {
    const lit = normal.reduce((sum, value, k) => sum + value * LIGHT[k], 0);
    const share = 0.7 * Math.max(0, lit) + 0.3 * (0.5 + 0.5 * lit);
    return [...sized[i], ...DARK.map((dark, k) => Math.round(dark + (BRIGHT[k] - dark) * share))].join(" ");
  });
  const properties = [
    ...["x", "y", "z"].map((name) => `float ${name}`),
    ...["red", "green", "blue"].map((name) => `uchar ${name}`),
  ];
  const header =
    `ply\nformat ascii 1.0\nelement vertex ${rows.length}\n${properties.map((each) => `property ${each}\n`).join("")}` +
    `element face ${triangles.length}\nproperty list uchar int vertex_indices\nend_header\n`;
  writeFileSync(ply, header + [...rows, ...triangles.map((corners) => `3 ${corners.join(" ")}`), ""].join("\n"));
  return triangles.reduce((sum, corners) => sum + area(...corners.map((corner) => sized[corner])), 0);
}

function area(a, b, c) {
  const [u, v] = [b, c].map((corner) => corner.map((value, k) => value - a[k]));
  return 0.5 * Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
}
