// The outline of a ball of few points: discs end at it, and leave no gaps.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, it } from "node:test";

import { WatchedPage } from "./support/browser.mjs";
import { ball } from "./support/meshes.mjs";
import { difference } from "./support/pictures.mjs";
import { Server, temporaryFolder } from "./support/server.mjs";

const front = { eye: [0, 0, 5], target: [0, 0, 0], up: [0, 1, 0], fov: 30 };

/// The radius of the ball's outline in a picture, in pixels.
function outlineOf({ eye, target, fov, orthographic = false }, { height }) {
  const distance = orthographic ? eye[2] - target[2] : Math.sqrt(eye[2] ** 2 - 1);
  return height / 2 / Math.tan((fov * Math.PI) / 360) / distance;
}

describe("a ball of 1000 points", () => {
  let server;
  let page;
  before(async () => {
    const mesh = join(temporaryFolder(), "ball.off");
    writeFileSync(mesh, ball());
    server = await Server.start("--open", mesh, "--max-curve-vertices", "0");
    page = await WatchedPage.open(`${server.url}#points=1000&edl=0&frustum=0`);
    await page.settled();
  });
  after(async () => {
    await page?.close();
    await server?.stop();
  });

  it("has no specks where discs are too small to overlap, until they are to show the points", async () => {
    await page.evaluate((c, camera) => (c.view.camera = camera), front);
    await page.change(() => page.set("points", 80_000));
    const holes = async (size) => {
      await page.set("size of discs", size);
      const picture = await page.picture(`specks_${size}.png`);
      const mask = difference(picture, await page.emptyPicture(), 3);
      const { width, height } = picture;
      const radius = outlineOf(front, picture);
      const isWithin = (i) => Math.hypot((i % width) - width / 2, Math.floor(i / width) - height / 2) < 0.9 * radius;
      return mask.filter((isDrawn, i) => !isDrawn && isWithin(i)).length;
    };
    const [closed, open] = [await holes(0.6), await holes(0.45)];
    console.log(`# holes: ${closed}, and ${open} of smaller discs`);
    assert.ok(closed < 10 && open > 100);
    await page.set("size of discs", 1);
    await page.change(() => page.set("points", 1000));
  });

  const parallel = { ...front, orthographic: true };
  const within = { ...parallel, eye: [0, 0, 0.5], target: [0, 0, -4.5] };
  for (const [what, screen, camera, most] of [
    ["even on the screen", true, front, 1],
    ["even on the surface", false, front, 0.3],
    ["seen by parallel rays", true, parallel, 1],
    ["seen by parallel rays that begin within", true, within, 1],
  ]) {
    it(`${what}, has a round outline and no holes`, async () => {
      const go = (to) => page.evaluate((c, wanted) => (c.view.camera = wanted), to);
      const { screen: isScreen } = await page.evaluate((c) => c.settings);
      if (isScreen !== screen) await page.change(() => page.set("even as seen from here", screen));
      if (screen) await page.change(() => go({ ...camera, fov: 40 })); // another one than before
      await (screen ? page.change(() => go(camera)) : go(camera));
      await page.settled();
      const picture = await page.picture(`${what.replaceAll(" ", "_")}.png`);
      const mask = difference(picture, await page.emptyPicture(), 3);
      const { width, height } = picture;
      const radius = outlineOf(await page.evaluate((c) => c.view.camera), picture);
      const wrong = { beyond: 0, missing: 0, holes: 0 };
      mask.forEach((isDrawn, i) => {
        const away = Math.hypot((i % width) + 0.5 - width / 2, Math.floor(i / width) + 0.5 - height / 2) - radius;
        if (isDrawn && away > 0.5) ++wrong.beyond;
        if (!isDrawn && away < -0.5) ++wrong.missing;
        if (!isDrawn && away < -0.1 * radius) ++wrong.holes;
      });
      const pixels = (wrong.beyond + wrong.missing) / (2 * Math.PI * radius);
      console.log(`# ${what}: ${JSON.stringify(wrong)}, ${pixels.toFixed(2)} pixels at the outline`);
      assert.equal(wrong.holes, 0);
      assert.ok(pixels < most, `the outline is ${pixels} pixels away from the ball's`);
    });
  }
});
