// Pictures of surfaces with sharp edges: discs end there.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, it } from "node:test";

import { WatchedPage } from "./support/browser.mjs";
import { cube, cubeCorners, cubeSides } from "./support/meshes.mjs";
import { countOf, difference } from "./support/pictures.mjs";
import { Server, temporaryFolder } from "./support/server.mjs";

const minus = (a, b) => a.map((value, k) => value - b[k]);
const dot = (a, b) => a.reduce((sum, value, k) => sum + value * b[k], 0);
const cross = (a, b) => [0, 1, 2].map((k) => a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
const unit = (a) => a.map((value) => value / Math.hypot(...a));

/// Where the corners of the cube's visible sides are in a picture, in pixels.
function visibleSides({ eye, target, up, fov }, { width, height }) {
  const forward = unit(minus(target, eye));
  const right = unit(cross(forward, up));
  const upwards = cross(right, forward);
  const half = height / 2 / Math.tan((fov * Math.PI) / 360); // pixels at distance 1
  const project = (corner) => {
    const away = minus(corner, eye);
    const scale = half / dot(away, forward);
    return [width / 2 + scale * dot(away, right), height / 2 - scale * dot(away, upwards)];
  };
  const isVisible = (side) => {
    const [a, b, c] = side.map((i) => cubeCorners[i]);
    return dot(cross(minus(b, a), minus(c, a)), minus(eye, a)) > 0;
  };
  return cubeSides.filter(isVisible).map((side) => side.map((i) => project(cubeCorners[i])));
}

/// How many pixels a place is inside of a convex side, the nearest to an edge of it.
function depthIn(side, [x, y]) {
  return Math.min(
    ...side.map(([ax, ay], i) => {
      const [bx, by] = side[(i + 1) % side.length];
      return ((bx - ax) * (ay - y) - (by - ay) * (ax - x)) / Math.hypot(bx - ax, by - ay);
    }),
  );
}

/// A picture of the cube, which pixels differ from the empty one, and where its visible sides are.
async function look(page, name) {
  const picture = await page.picture(name);
  const mask = difference(picture, await page.emptyPicture(), 3);
  return { picture, mask, sides: visibleSides(await page.evaluate((c) => c.view.camera), picture) };
}

describe("a cube", () => {
  let server;
  let page;
  before(async () => {
    const mesh = join(temporaryFolder(), "cube.off");
    writeFileSync(mesh, cube());
    server = await Server.start("--open", mesh, "--max-curve-vertices", "0");
    // The density of the screen has no points on the sides that are hidden, behind the outline.
    page = await WatchedPage.open(`${server.url}#points=20000&screen=0&frustum=0`);
    await page.settled();
  });
  after(async () => {
    await page?.close();
    await server?.stop();
  });

  it("has straight edges, up to which each side has one shade", async () => {
    const { picture, mask, sides } = await look(page, "cube.png");
    assert.equal(sides.length, 3);
    const { width, data } = picture;
    const wrong = { beyond: [], missing: [], spotted: [] };
    mask.forEach((isDrawn, i) => {
      const place = [(i % width) + 0.5, Math.floor(i / width) + 0.5];
      const depths = sides.map((side) => depthIn(side, place));
      const depth = Math.max(...depths);
      if (depth < -1 && isDrawn) wrong.beyond.push(place);
      if (depth > 1 && !isDrawn) wrong.missing.push(place);
      if (depth < 1.5) return;
      const side = sides[depths.indexOf(depth)];
      const middle = [0, 1].map((k) => side.reduce((sum, corner) => sum + corner[k], 0) / side.length);
      const away = minus(middle, place);
      const share = Math.min(1, 12 / Math.hypot(...away));
      const [x, y] = place.map((value, k) => Math.floor(value + share * away[k]));
      const j = y * width + x;
      if ([0, 1, 2].some((k) => Math.abs(data[4 * i + k] - data[4 * j + k]) > 6)) wrong.spotted.push(place);
    });
    assert.ok(countOf(mask) > 0.1 * mask.length, "the cube is there");
    for (const [name, places] of Object.entries(wrong)) {
      assert.ok(places.length <= 5, `${name}: ${places.length} pixels, ${places.slice(0, 5).join(" and ")} among them`);
    }
  });

  it("has hardly a gap in a side that is seen flatly, by few points that are even on the screen", async () => {
    await page.set("even as seen from here", true);
    await page.change(() => page.set("points", 5000));
    for (const height of [1.4, 2]) {
      const camera = { eye: [3, height, 7], target: [0, 0, 0], up: [0, 1, 0], fov: 30 };
      await page.change(() => page.evaluate((c, wanted) => (c.view.camera = wanted), camera));
      await page.settled();
      const { picture, mask, sides } = await look(page, `flat_${height}.png`);
      let gaps = 0;
      mask.forEach((isDrawn, i) => {
        const place = [(i % picture.width) + 0.5, Math.floor(i / picture.width) + 0.5];
        if (!isDrawn && sides.some((side) => depthIn(side, place) > 0.5)) ++gaps;
      });
      assert.ok(gaps <= 10, `${gaps} pixels from a height of ${height}`);
    }
  });
});
