// One session, drawn by the project's own viewer and by programs that are not ours, with one camera, in one picture. deploy/side_by_side
// runs it: node side_by_side.mjs MESH FOLDER.

import assert from "node:assert/strict";
import { rmSync } from "node:fs";
import { join } from "node:path";

import { browser, closeBrowser, WatchedPage } from "../../../client/web/support/browser.mjs";
import { chromium, PNG } from "../../../client/web/support/environment.mjs";
import { Server } from "../../../client/web/support/server.mjs";
import { curvecast, folder, Packages } from "../coloured_points.mjs";
import { Studio } from "../splats/drawn.mjs";
import { makeColoured } from "./coloured_mesh.mjs";

const [mesh, results] = process.argv.slice(2);
const [SPLATS, TILES] = ["splats", "tiles"].map((name) => new Packages(`build/${name}/node_modules`));

const SIDE = 480; // pixels of each picture
const VERTICES = 60_000; // of the mesh
const POINTS = 60_000; // of each picture that is not of tiles
const DEEPEST = 65_536; // points of all tiles; this and what is fewer is one session to the command
const PIXEL_ERROR = 4; // of tiles
const CAMERA = { eye: [-1.5, 0.9, -2.9], target: [0, 0, 0], up: [0, 1, 0], fov: 40 };

/** A mesh of unit size, with colours, and how far apart so many points are on it. */
function prepare() {
  const [whole, coloured] = [join(folder, "mesh.obj"), join(folder, "mesh.ply")];
  curvecast("remesh", mesh, "-n", String(VERTICES), "-o", whole);
  const area = makeColoured(whole, coloured);
  return { coloured, spacing: (count) => Math.sqrt(area / count) };
}

/** Makes files of the server's session in the folder, by their names. */
function makeFiles(mesh, { grpc }) {
  curvecast("tiles", mesh, "-n", String(DEEPEST), "--server", grpc, "-o", join(folder, "tiles"));
  for (const [name, ...flags] of [["points.glb"], ["splats.spz"], ["splats.glb", "--splats"]]) {
    curvecast("sample", mesh, "-n", String(POINTS), ...flags, "--server", grpc, "-o", join(folder, name));
  }
}

async function drawOwn({ url, sessions }) {
  const { eye, target, up, fov } = CAMERA;
  const hash = `session=${sessions[0]}&camera=${[...eye, ...target, ...up, fov]}&points=${POINTS}&colouring=colour&background=light`;
  const page = await WatchedPage.open(`${url}#${hash}`, { viewport: { width: SIDE, height: SIDE } });
  await page.settled();
  const picture = await page.picture();
  await page.close();
  return { count: POINTS, picture };
}

/** Draws with a page of each program; [what stands below, picture] of each. */
async function drawAll(server, spacing) {
  const tiles = "tiles/tileset.json";
  const ofTiles = { error: PIXEL_ERROR, size: 5, spacing: 2.6 * spacing(POINTS) };
  const programs = [
    [TILES, "Cesium", "cesium", "3D Tiles", "tiles/cesium_page.js", tiles, ofTiles],
    [TILES, "3d-tiles-renderer", "3d-tiles-renderer", "3D Tiles", "tiles/three_page.js", tiles, ofTiles],
    [SPLATS, "Spark", "@sparkjsdev/spark", ".spz", "splats/spark_page.js", "splats.spz", {}],
    [SPLATS, "PlayCanvas", "playcanvas", ".glb of splats", "splats/playcanvas_page.js", "splats.glb", {}],
    [SPLATS, "three.js", "three", ".glb", "side_by_side/points_page.js", "points.glb", { spacing: 2 * spacing(POINTS) }],
  ];
  const drawn = [["Curvecast's viewer, by its stream", await drawOwn(server)]];
  for (const [packages, program, name, format, script, file, more] of programs) {
    const studio = await Studio.open(chromium, PNG, packages.folder, folder);
    const made = await studio.draw(script, file, { ...CAMERA, ...more }, SIDE, SIDE);
    await studio.close();
    assert.deepEqual(made.failed ?? [], []);
    drawn.push([`${packages.named(name, program)}, ${format}`, made]);
  }
  return drawn;
}

/** The pictures with their words, as a page that needs nothing else. */
function pageOf(drawn) {
  const figures = drawn.map(([words, { count, picture }]) => {
    const source = `data:image/png;base64,${PNG.sync.write(picture).toString("base64")}`;
    return `<figure><img src="${source}"><figcaption>${words}<br>${count.toLocaleString("en")} points</figcaption></figure>`;
  });
  return `<!doctype html><style>
    body { margin: 0; display: grid; grid-template-columns: repeat(3, 1fr); font: 18px sans-serif; background: #ebebeb }
    figure { margin: 0; text-align: center; overflow: hidden }
    img { width: 100%; display: block }
    figcaption { padding: 4px 0 14px; line-height: 1.35 }
  </style>${figures.join("")}`;
}

const { coloured, spacing } = prepare();
const server = await Server.start("--open", coloured, "--cache", folder);
try {
  makeFiles(coloured, server);
  const drawn = await drawAll(server, spacing);
  const { sessions } = await (await fetch(`http://${server.http}/v1/sessions`)).json();
  assert.equal(sessions.length, 1);
  const page = await (await browser()).newPage({ viewport: { width: 3 * SIDE, height: 100 } });
  await page.setContent(pageOf(drawn));
  await page.screenshot({ path: join(results, "side_by_side.png"), fullPage: true });
  await page.setViewportSize({ width: 960, height: 100 });
  await page.addStyleTag({ content: "body { font-size: 13px }" });
  await page.screenshot({ path: join(results, "side_by_side.jpg"), type: "jpeg", quality: 88, fullPage: true });
  for (const [words, { count }] of drawn) console.log(`${words}: ${count} points of session ${server.sessions[0]}`);
} finally {
  await closeBrowser();
  await server.stop();
  rmSync(folder, { recursive: true });
}
