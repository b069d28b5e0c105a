// A torus, a view of it, and which pixels of that the mesh itself has: what pictures of its tiles are held against.

import { readFileSync } from "node:fs";
import { join } from "node:path";

import { curvecast, folder, writeTorus } from "../coloured_points.mjs";
import { maskOf } from "../splats/drawn.mjs";

export const [WIDTH, HEIGHT] = [720, 540];
export const CAMERA = { eye: [1.2, 2.1, 2.6], target: [0, 0, 0], up: [0, 1, 0], fov: 40 };
export const LEAST_COVERED = 0.99;
export const MOST_AT_FIRST = 300_000; // bytes of the first picture
const AREA = 4 * Math.PI ** 2 * 0.4; // of the torus

// With the error in pixels that both want where nobody says otherwise. About so far apart as the spacing are the points of the levels
// that the first picture comes to.
const spacing = Math.sqrt(AREA / 16_384);
export const VIEWERS = [
  {
    name: "3d-tiles-renderer",
    page: "tiles/three_page.js",
    error: 16,
    first: { spacing: 2 * spacing },
    deeper: { spacing: 0.008 },
  },
  { name: "Cesium", page: "tiles/cesium_page.js", error: 16, first: { size: 10 }, deeper: { size: 2 } },
];

/** Writes the mesh, and draws it with the command. Returns its path and the pixels that it has. */
export function drawTorus(PNG) {
  const mesh = writeTorus("torus.ply");
  const view = `eye=${CAMERA.eye},target=${CAMERA.target},up=${CAMERA.up},fov=${CAMERA.fov}`;
  for (const [name, at] of [
    ["mesh.png", view],
    ["none.png", "eye=50,50,50,target=90,90,90"],
  ]) {
    curvecast("render", mesh, "--what", "shaded", "--camera", at, "--size", `${WIDTH}x${HEIGHT}`, "-o", join(folder, name));
  }
  const [own, none] = ["mesh.png", "none.png"].map((name) => PNG.sync.read(readFileSync(join(folder, name))));
  return { mesh, mask: maskOf(own, none) };
}

/** How much of the mesh's own pixels a picture covers, with what has any alpha. */
export function covered(picture, mask) {
  let [inside, shown] = [0, 0];
  mask.forEach((is, i) => {
    inside += is;
    shown += is && picture.data[4 * i + 3] > 0;
  });
  return shown / inside;
}
