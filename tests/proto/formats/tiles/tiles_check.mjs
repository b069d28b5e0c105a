// 3d-tiles-renderer and Cesium load and draw 3D Tiles: deploy/check_formats fetches these programs.

import assert from "node:assert/strict";
import { mkdirSync, readFileSync, rmSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, it } from "node:test";

import { curvecast, folder, Packages, writeTorus } from "../coloured_points.mjs";
import { maskOf, Studio } from "../splats/drawn.mjs";

const packages = new Packages(process.env.CURVECAST_NODE_MODULES ?? "build/tiles/node_modules");
const { chromium } = packages.require("playwright-core");
const { PNG } = packages.require("pngjs");
const pictures = process.env.CURVECAST_SCREENSHOTS ?? join(folder, "pictures");
mkdirSync(pictures, { recursive: true });

const POINTS = 4_000_000;
const MOST_AT_FIRST = 300_000; // bytes of the first picture
const [WIDTH, HEIGHT] = [720, 540];
const CAMERA = { eye: [1.2, 2.1, 2.6], target: [0, 0, 0], up: [0, 1, 0], fov: 40 };
const LEAST_COVERED = 0.99;
const AREA = 4 * Math.PI ** 2 * 0.4; // of the torus

/** How much of the mesh's own pixels a picture covers, with what has any alpha. */
function covered(picture, mask) {
  let [inside, shown] = [0, 0];
  mask.forEach((is, i) => {
    inside += is;
    shown += is && picture.data[4 * i + 3] > 0;
  });
  return shown / inside;
}

describe("a tileset", () => {
  let studio;
  let mask;
  before(async () => {
    const mesh = writeTorus("torus.ply");
    curvecast("tiles", mesh, "-n", String(POINTS), "-o", join(folder, "tiles"));
    const view = `eye=${CAMERA.eye},target=${CAMERA.target},up=${CAMERA.up},fov=${CAMERA.fov}`;
    for (const [name, at] of [
      ["mesh.png", view],
      ["none.png", "eye=50,50,50,target=90,90,90"],
    ]) {
      curvecast("render", mesh, "--what", "shaded", "--camera", at, "--size", `${WIDTH}x${HEIGHT}`, "-o", join(folder, name));
    }
    const [own, none] = ["mesh.png", "none.png"].map((name) => PNG.sync.read(readFileSync(join(folder, name))));
    mask = maskOf(own, none);
    studio = await Studio.open(chromium, PNG, packages.folder, folder);
  });
  after(async () => {
    await studio?.close();
    rmSync(folder, { recursive: true });
  });

  // With the error in pixels that both want where nobody says otherwise.
  for (const [name, page, error, more] of [
    ["3d-tiles-renderer", "tiles/three_page.js", 16, (spacing) => ({ spacing: 2 * spacing })],
    ["Cesium", "tiles/cesium_page.js", 16, () => ({ size: 10 })],
  ]) {
    it(`is drawn by ${name}, whose first picture takes few bytes`, async (test) => {
      const first = studio.bytes;
      // About so far apart are the points of the levels that the picture comes to.
      const spacing = Math.sqrt(AREA / 16_384);
      const made = await studio.draw(page, "tiles/tileset.json", { ...CAMERA, error, ...more(spacing) }, WIDTH, HEIGHT);
      const bytes = studio.bytes - first;
      const share = covered(made.picture, mask);
      test.diagnostic(`${made.count} points, ${bytes} bytes, ${(100 * share).toFixed(2)} % of the mesh's pixels`);
      await studio.save(made.picture, join(pictures, `tiles_${name}.png`));
      assert.deepEqual(made.failed, []);
      assert.ok(made.count > 4000 && made.count < POINTS / 10, `${made.count} points`);
      assert.ok(bytes <= MOST_AT_FIRST, `${bytes} bytes`);
      assert.ok(share >= LEAST_COVERED, `${share} of the mesh's pixels`);
    });

    it(`is loaded deeper by ${name} where less error is wanted`, async (test) => {
      const made = await studio.draw(page, "tiles/tileset.json", { ...CAMERA, error: error / 6, ...more(0.004) }, WIDTH, HEIGHT);
      test.diagnostic(`${made.count} points`);
      assert.deepEqual(made.failed, []);
      assert.ok(made.count > 60_000, `${made.count} points`);
    });
  }
});
