// 3d-tiles-renderer and Cesium load and draw 3D Tiles: deploy/check_formats fetches these programs.

import assert from "node:assert/strict";
import { mkdirSync, rmSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, it } from "node:test";

import { curvecast, folder, Packages } from "../coloured_points.mjs";
import { Studio } from "../splats/drawn.mjs";
import { CAMERA, covered, drawTorus, HEIGHT, LEAST_COVERED, MOST_AT_FIRST, VIEWERS, WIDTH } from "./torus_scene.mjs";

const packages = new Packages(process.env.CURVECAST_NODE_MODULES ?? "build/tiles/node_modules");
const { chromium } = packages.require("playwright-core");
const { PNG } = packages.require("pngjs");
const pictures = process.env.CURVECAST_SCREENSHOTS ?? join(folder, "pictures");
mkdirSync(pictures, { recursive: true });

const POINTS = 4_000_000;

describe("a tileset", () => {
  let studio;
  let mask;
  before(async () => {
    const torus = drawTorus(PNG);
    mask = torus.mask;
    curvecast("tiles", torus.mesh, "-n", String(POINTS), "-o", join(folder, "tiles"));
    studio = await Studio.open(chromium, PNG, packages.folder, folder);
  });
  after(async () => {
    await studio?.close();
    rmSync(folder, { recursive: true });
  });

  for (const { name, page, error, first, deeper } of VIEWERS) {
    it(`is drawn by ${name}, whose first picture takes few bytes`, async (test) => {
      const before = studio.bytes;
      const made = await studio.draw(page, "tiles/tileset.json", { ...CAMERA, error, ...first }, WIDTH, HEIGHT);
      const bytes = studio.bytes - before;
      const share = covered(made.picture, mask);
      test.diagnostic(`${made.count} points, ${bytes} bytes, ${(100 * share).toFixed(2)} % of the mesh's pixels`);
      await studio.save(made.picture, join(pictures, `tiles_${name}.png`));
      assert.deepEqual(made.failed, []);
      assert.ok(made.count > 4000 && made.count < POINTS / 10, `${made.count} points`);
      assert.ok(bytes <= MOST_AT_FIRST, `${bytes} bytes`);
      assert.ok(share >= LEAST_COVERED, `${share} of the mesh's pixels`);
    });

    it(`is loaded deeper by ${name} where less error is wanted`, async (test) => {
      const made = await studio.draw(page, "tiles/tileset.json", { ...CAMERA, error: error / 6, ...deeper }, WIDTH, HEIGHT);
      test.diagnostic(`${made.count} points`);
      assert.deepEqual(made.failed, []);
      assert.ok(made.count > 60_000, `${made.count} points`);
    });
  }
});
