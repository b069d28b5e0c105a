// The surface's own triangles: where the user wants them, and where they are fewer bytes than points.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, afterEach, before, describe, it } from "node:test";

import { WatchedPage } from "./support/browser.mjs";
import { PNG } from "./support/environment.mjs";
import { cubeCorners, cubeSides } from "./support/meshes.mjs";
import { countOf, difference, writeBeside } from "./support/pictures.mjs";
import { Server, temporaryFolder } from "./support/server.mjs";
import { openTorus, sharedServer } from "./support/shared_server.mjs";

const shows = (page) => page.until((c) => c.surface !== null);
const isHidden = (page) => page.until((c) => c.surface === null);
const figures = (page) => page.page.locator(".hud dd.surface");

/// The mean difference of two pictures, in steps of a channel.
function meanDifference(a, b) {
  let sum = 0;
  a.data.forEach((value, i) => (sum += Math.abs(value - b.data[i])));
  return sum / (3 * a.width * a.height); // alphas are the same
}

/// Turns the camera a little, and waits until that is drawn.
async function turn(page) {
  await page.evaluate((c) => {
    const { camera } = c.view;
    c.view.camera = { ...camera, eye: camera.eye.map((value, k) => value + (k === 0 ? 0.3 : 0)) };
  });
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
}

/// A cube with a texture.
function texturedCube() {
  const folder = temporaryFolder();
  const image = new PNG({ width: 2, height: 2 });
  image.data.fill(200);
  writeFileSync(join(folder, "cube.png"), PNG.sync.write(image));
  writeFileSync(join(folder, "cube.mtl"), "newmtl paper\nmap_Kd cube.png\n");
  const lines = [
    "mtllib cube.mtl",
    ...cubeCorners.map((corner) => `v ${corner.join(" ")}`),
    ...["0 0", "1 0", "1 1", "0 1"].map((uv) => `vt ${uv}`),
    "usemtl paper",
    ...cubeSides.map((side) => `f ${side.map((v, i) => `${v + 1}/${i + 1}`).join(" ")}`),
  ];
  writeFileSync(join(folder, "cube.obj"), lines.join("\n") + "\n");
  return join(folder, "cube.obj");
}

describe("the surface's own triangles", () => {
  let torus;
  before(async () => (torus = await openTorus("points=50000", { viewport: { width: 900, height: 480 } })));
  afterEach(() => torus.assertFine());
  after(() => torus.close());

  it("look as 50,000 discs do", async () => {
    const discs = await torus.picture();
    const pick = await torus.evaluate((c) => c.view.pick(200, 240));
    await torus.page.keyboard.press("3");
    await shows(torus);
    assert.equal(await torus.evaluate((c) => c.surface.triangles.length / 3), 2 * 120 * 48);
    const mesh = await torus.picture();
    writeBeside("discs_and_mesh.png", discs, mesh);
    const mean = meanDifference(discs, mesh);
    assert.ok(mean < 1.5, `the pictures differ by ${mean} on average`);
    const empty = await torus.emptyPicture(); // of the mesh, too: its triangles are no store's
    assert.equal(countOf(difference(mesh, empty)), 0);
    const far = countOf(difference(discs, mesh, 60)) / (mesh.width + mesh.height);
    assert.ok(far < 2, `${far} of the pixels of an edge are others`);
    const picked = await torus.evaluate((c) => c.view.pick(200, 240));
    assert.equal(pick === null, picked === null);
    const away = Math.hypot(...pick.point.map((value, k) => value - picked.point[k]));
    assert.ok(away < 0.01, `picks are ${away} apart`);
    await figures(torus)
      .filter({ hasText: /^mesh: 11,520 triangles, [\d.]+ KB$/ })
      .waitFor();
  });

  it("need no points: these are asked for again when they show", async () => {
    const look = await torus.evaluate((c) => c.look);
    await turn(torus);
    assert.equal(await torus.evaluate((c) => c.look), look);
    await torus.change(() => torus.page.keyboard.press("1"));
    await isHidden(torus);
    await figures(torus).waitFor({ state: "hidden" });
    await torus.page.keyboard.press("3");
    await shows(torus);
  });

  it("are cut open, for the pointer too", async () => {
    const whole = await torus.picture();
    const places = (c) => {
      const found = [];
      for (let x = 10; x < 600; x += 10) for (let y = 10; y < 480; y += 10) found.push(c.view.pick(x, y)?.point ?? null);
      return found.filter((point) => point !== null);
    };
    assert.ok((await torus.evaluate(places)).some(([x]) => x > 0.2));
    await torus.set("cut across", "X");
    const half = await torus.picture("mesh_cut.png");
    assert.ok(countOf(difference(whole, half)) > 0.05 * half.width * half.height);
    assert.ok((await torus.evaluate(places)).every(([x]) => x < 0.001));
    await torus.set("cut across", "no");
    assert.equal(countOf(difference(whole, await torus.picture())), 0);
  });

  it("are in the address", async () => {
    await torus.page.waitForFunction(() => location.hash.includes("mode=mesh"));
    const again = await WatchedPage.open(await torus.page.evaluate(() => location.href));
    await shows(again);
    assert.equal(await again.evaluate((c) => c.settings.mode), "mesh");
    await again.close();
  });

  it("are shown beside even points where these are wanted", async () => {
    await torus.change(() => torus.page.keyboard.press("v"));
    await shows(torus);
    await torus.until((c) => c.uniformStore?.count > 0);
    await torus.screenshot("mesh_beside_points.png");
    await torus.page.keyboard.press("v");
  });
});

describe("a small mesh", () => {
  let torus;
  before(async () => (torus = await WatchedPage.open(`${(await sharedServer()).url}#budget=automatic`)));
  afterEach(() => torus.assertFine());
  after(() => torus.close());

  it("is shown at once, and no points are asked for", async () => {
    await shows(torus);
    await turn(torus);
    assert.deepEqual(await torus.evaluate((c) => [c.look, c.settings.mode]), [0, "splats"]);
    await figures(torus)
      .filter({ hasText: /fewer bytes than points$/ })
      .waitFor();
    await torus.page.locator(".hud .state", { hasText: "live" }).waitFor();
    await torus.page.keyboard.press("x");
    await torus.page.getByText("There are no points yet").waitFor();
    await torus.screenshot("small_mesh.png");
  });

  it("is given up for points when these are painted, and comes back", async () => {
    await torus.change(() => torus.page.keyboard.press("b"));
    await isHidden(torus);
    await torus.settled();
    const x = await torus.evaluate((c) => Array.from({ length: 60 }, (_, i) => 10 * i).find((at) => c.view.pick(at, 240) !== null));
    await torus.page.mouse.click(x + 10, 240);
    await torus.until((c) => c.settings.dabs.length > 0);
    await torus.page.keyboard.press("b");
    await torus.settled();
    assert.equal(await torus.evaluate((c) => c.surface), null, "there is paint");
    await torus.page.keyboard.press("Delete");
    await shows(torus);
  });

  it("is given up where so many points are wanted, and for what only points have", async () => {
    for (const [change, back] of [
      [() => torus.set("limit", "number of points"), () => torus.set("limit", "speed (automatic)")],
      [() => torus.set("colours", "density"), () => torus.set("colours", "the surface's own")],
      [() => torus.page.keyboard.press("z"), () => torus.page.keyboard.press("z")],
    ]) {
      await change();
      await isHidden(torus);
      await torus.settled();
      await back();
      await shows(torus);
    }
  });
});

describe("a surface with a texture", () => {
  let server;
  let page;
  before(async () => {
    server = await Server.start("--open", texturedCube());
    page = await WatchedPage.open(server.url);
  });
  after(async () => {
    await page?.close();
    await server?.stop();
  });

  it("is shown by discs, and why is said once it is asked for", async () => {
    const notices = page.page.locator("[role=status], [role=alert]").filter({ hasText: /mesh cannot be shown: .*texture/ });
    await page.settled();
    assert.equal(await notices.count(), 0);
    await page.page.keyboard.press("3");
    await notices.first().waitFor();
    assert.equal(await page.evaluate((c) => c.surface), null);
    assert.ok((await page.evaluate((c) => c.store.count)) > 0);
    await page.change(() => turn(page));
    page.assertFine();
  });
});
