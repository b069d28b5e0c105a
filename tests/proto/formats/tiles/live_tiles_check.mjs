// 3d-tiles-renderer and Cesium load and draw the 3D Tiles of a running server, which is of another origin than their pages and wants a
// token.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { createHash } from "node:crypto";
import { once } from "node:events";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, it } from "node:test";

import { command, folder, Packages } from "../coloured_points.mjs";
import { Studio } from "../splats/drawn.mjs";
import { CAMERA, covered, drawTorus, HEIGHT, LEAST_COVERED, MOST_AT_FIRST, VIEWERS, WIDTH } from "./torus_scene.mjs";

const packages = new Packages(process.env.CURVECAST_NODE_MODULES ?? "build/tiles/node_modules");
const { chromium } = packages.require("playwright-core");
const { PNG } = packages.require("pngjs");
const pictures = process.env.CURVECAST_SCREENSHOTS ?? join(folder, "pictures");
mkdirSync(pictures, { recursive: true });

const POINTS = 500_000;
const TOKEN = "of-viewers";
const headers = { authorization: `Bearer ${TOKEN}` };

/** Starts a server that pages of an origin may ask. Returns its process and address. */
async function serve(origin) {
  const tokens = join(folder, "tokens");
  writeFileSync(tokens, `viewer ${createHash("sha256").update(TOKEN).digest("hex")}\n`);
  const words = [
    "serve",
    "--quiet",
    "--listen",
    "127.0.0.1:0",
    "--http",
    "127.0.0.1:0",
    "--tokens",
    tokens,
    "--web-origin",
    origin,
  ];
  const server = spawn("setpriv", ["--pdeathsig", "TERM", command, ...words], { stdio: ["ignore", "pipe", "inherit"] });
  let text = "";
  while (!/http on (\S+)/.test(text)) text += (await once(server.stdout, "data"))[0];
  return { server, address: `http://${/http on (\S+)/.exec(text)[1]}` };
}

/** What a request gets; fails where that is an error. */
async function ask(url, options = {}) {
  const answer = await fetch(url, { ...options, headers: { ...headers, ...options.headers } });
  assert.ok(answer.ok, `${url}: ${answer.status}`);
  return answer;
}

describe("the tileset of a server", () => {
  let studio;
  let mask;
  let server;
  let tileset;
  let bytes = 0; // that the server has sent to pages
  before(async () => {
    const torus = drawTorus(PNG);
    mask = torus.mask;
    studio = await Studio.open(chromium, PNG, packages.folder, folder);
    const started = await serve(`http://127.0.0.1:${studio.server.address().port}`);
    server = started.server;
    const newPage = studio.browser.newPage.bind(studio.browser);
    studio.browser.newPage = async (options) => {
      const page = await newPage(options);
      page.on("response", (answer) => {
        if (answer.url().startsWith(started.address)) bytes += Number(answer.headers()["content-length"] ?? 0);
      });
      return page;
    };
    const put = await ask(`${started.address}/v1/meshes/torus.ply`, { method: "PUT", body: readFileSync(torus.mesh) });
    const made = await ask(`${started.address}/v1/sessions`, {
      method: "POST",
      headers: { "content-type": "application/json" },
      body: JSON.stringify({ meshId: (await put.json()).meshId, options: { maxPoints: String(POINTS) } }),
    });
    tileset = `${started.address}${made.headers.get("location")}/tileset.json?n=${POINTS}`;
  });
  after(async () => {
    await studio?.close();
    server?.kill("SIGTERM");
    rmSync(folder, { recursive: true });
  });

  it("is there, with tiles that may be kept", async (test) => {
    const start = performance.now();
    const top = await (await ask(tileset)).json();
    test.diagnostic(`${POINTS} points and their tiles in ${((performance.now() - start) / 1000).toFixed(1)} s`);
    assert.equal(top.extras.points, POINTS);
    const root = await ask(new URL(top.root.content.uri, tileset));
    assert.match(root.headers.get("cache-control"), /immutable/);
    const { status } = await fetch(tileset);
    assert.equal(status, 401, "without the token");
  });

  for (const { name, page, error, first, deeper } of VIEWERS) {
    it(`is drawn by ${name}, whose first picture takes few bytes`, async (test) => {
      const before = bytes;
      const made = await studio.draw(page, tileset, { ...CAMERA, error, headers, ...first }, WIDTH, HEIGHT);
      const share = covered(made.picture, mask);
      test.diagnostic(`${made.count} points, ${bytes - before} bytes, ${(100 * share).toFixed(2)} % of the mesh's pixels`);
      await studio.save(made.picture, join(pictures, `live_tiles_${name}.png`));
      assert.deepEqual(made.failed, []);
      assert.ok(made.count > 4000 && made.count < POINTS / 10, `${made.count} points`);
      assert.ok(bytes > before && bytes - before <= MOST_AT_FIRST, `${bytes - before} bytes`);
      assert.ok(share >= LEAST_COVERED, `${share} of the mesh's pixels`);
    });

    it(`is loaded deeper by ${name} where less error is wanted`, async (test) => {
      const made = await studio.draw(page, tileset, { ...CAMERA, error: error / 6, headers, ...deeper }, WIDTH, HEIGHT);
      test.diagnostic(`${made.count} points`);
      assert.deepEqual(made.failed, []);
      assert.ok(made.count > 60_000, `${made.count} points`);
    });
  }
});
