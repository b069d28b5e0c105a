// What the page shows, and how settings and the pointer change it.

import assert from "node:assert/strict";
import { after, afterEach, before, describe, it } from "node:test";

import { boxOf, countOf, difference } from "./support/pictures.mjs";
import { openTorus } from "./support/shared_server.mjs";

const points = 5000;

/// The mean of |n · v| over the points of the store, v being the direction to the eye: small where many are at the silhouette.
const facing = (c) => {
  const { store, view } = c;
  let sum = 0;
  for (const slot of store.order()) {
    const v = [0, 1, 2].map((k) => view.camera.eye[k] - store.origin[k] - store.positions[4 * slot + k]);
    const n = [0, 1, 2].map((k) => store.normals[4 * slot + k]);
    sum += Math.abs(n[0] * v[0] + n[1] * v[1] + n[2] * v[2]) / Math.hypot(...n) / Math.hypot(...v);
  }
  return sum / store.count;
};

/// The mean of |Gaussian curvature| over the points of the store, which has to have curvatures.
const bending = (c) => {
  let sum = 0;
  for (const slot of c.store.order()) sum += Math.abs(c.store.curvatures[2 * slot] * c.store.curvatures[2 * slot + 1]);
  return sum / c.store.count;
};

const cameraOf = (c) => c.view.camera;
const distanceOf = ({ eye, target }) => Math.hypot(...eye.map((value, k) => value - target[k]));

function assertChanged(a, b, what, minShare = 0.01) {
  const share = countOf(difference(a, b)) / (a.width * a.height);
  assert.ok(share > minShare, `${what}: ${(100 * share).toFixed(2)} % of the pixels have changed`);
}

describe("the picture", () => {
  let torus;
  before(async () => (torus = await openTorus()));
  afterEach(() => torus.assertFine());
  after(() => torus.close());

  it("shows the surface, whole and in the middle", async () => {
    assert.equal(await torus.evaluate((c) => c.store.count), points);
    const picture = await torus.picture("torus.png");
    const { width, height } = picture;
    const mask = difference(picture, await torus.emptyPicture(), 0);
    const share = countOf(mask) / (width * height);
    assert.ok(share > 0.1 && share < 0.7, `the surface covers ${(100 * share).toFixed(1)} %`);
    const box = boxOf(mask, width);
    assert.ok(box.left > 0 && box.top > 0 && box.right < width - 1 && box.bottom < height - 1, "nothing is cut off");
    assert.ok(
      Math.abs(box.left + box.right - width) < 0.3 * width && Math.abs(box.top + box.bottom - height) < 0.3 * height,
      "in the middle",
    );
    assert.ok(box.right - box.left > 0.4 * width || box.bottom - box.top > 0.4 * height, "it fills the picture");
    await torus.screenshot("page.png");
  });

  it("has the surface's own colours", async () => {
    const { data, width, height } = await torus.picture();
    let coloured = 0;
    for (let i = 0; i < width * height; ++i) {
      const [red, green, blue] = data.subarray(4 * i, 4 * i + 3);
      if (Math.max(red, green, blue) - Math.min(red, green, blue) > 100) ++coloured; // clay has half of that
    }
    assert.ok(coloured > 0.05 * width * height, `${coloured} pixels have a colour`);
  });

  it("turns with the mouse, and keeps its points", async () => {
    const [from, picture] = [await torus.evaluate(cameraOf), await torus.picture()];
    const deltas = await torus.evaluate((c) => c.statistics.deltas);
    await torus.change(() =>
      torus.drag([
        [320, 240],
        [380, 260],
      ]),
    );
    const to = await torus.evaluate(cameraOf);
    assert.notDeepEqual(to.eye, from.eye);
    assert.ok((await torus.evaluate((c) => c.statistics.deltas)) > deltas, "views are answered by deltas");
    assert.equal(await torus.evaluate((c) => c.store.count), points);
    assertChanged(picture, await torus.picture(), "turned");
  });

  it("zooms with the wheel, to what is under the pointer", async () => {
    const from = await torus.evaluate(cameraOf);
    await torus.page.mouse.move(320, 240);
    await torus.change(() => torus.page.mouse.wheel(0, -240));
    const near = await torus.evaluate(cameraOf);
    assert.ok(distanceOf(near) < 0.9 * distanceOf(from), "nearer");
    await torus.change(() => torus.page.mouse.wheel(0, 240));
    assert.ok(distanceOf(await torus.evaluate(cameraOf)) > distanceOf(near), "farther");
  });

  it("moves with the right button, and looks where it is double clicked", async () => {
    const from = await torus.evaluate(cameraOf);
    await torus.change(() =>
      torus.drag(
        [
          [320, 240],
          [360, 220],
        ],
        "right",
      ),
    );
    const to = await torus.evaluate(cameraOf);
    assert.notDeepEqual(to.target, from.target);
    assert.ok(Math.abs(distanceOf(to) - distanceOf(from)) < 1e-3 * distanceOf(from), "at the same distance");
    const place = await torus.evaluate((c) => {
      for (let x = 20; x < 620; x += 10) {
        const pick = c.view.pick(x, 240);
        if (pick !== null) return { x, point: pick.point };
      }
      return null;
    });
    assert.ok(place !== null, "the torus can be picked");
    await torus.page.mouse.dblclick(place.x, 240);
    await torus.until(
      (c, [x, y, z]) => Math.hypot(...[x, y, z].map((value, k) => value - c.view.camera.target[k])) < 0.05,
      place.point,
    );
    await torus.settled();
  });

  it("obeys the keyboard, and shows the whole again", async () => {
    const from = await torus.evaluate(cameraOf);
    await torus.change(() => torus.page.keyboard.press("ArrowLeft"));
    const turned = await torus.evaluate(cameraOf);
    assert.notDeepEqual(turned.eye, from.eye);
    await torus.change(() => torus.page.keyboard.press("+"));
    assert.ok(distanceOf(await torus.evaluate(cameraOf)) < distanceOf(turned), "nearer");
    await torus.change(() => torus.page.keyboard.press("f"));
    const picture = await torus.picture();
    const { width, height } = picture;
    const box = boxOf(difference(picture, await torus.emptyPicture(), 0), width);
    assert.ok(box.left > 0 && box.top > 0 && box.right < width - 1 && box.bottom < height - 1, "nothing is cut off");
  });

  it("takes as many points as it is told", async () => {
    await torus.change(() => torus.page.keyboard.press("]"));
    assert.equal(await torus.evaluate((c) => c.store.count), 2 * points);
    await torus.change(() => torus.set("points", 3000));
    assert.equal(await torus.evaluate((c) => c.store.count), 3000);
    await torus.set("kilobytes", 8);
    await torus.change(() => torus.set("limit", "size of data"));
    const few = await torus.evaluate((c) => c.store.count);
    await torus.change(() => torus.set("kilobytes", 24));
    assert.ok((await torus.evaluate((c) => c.store.count)) > 2 * few, "more bytes, more points");
    await torus.set("pixels a point", 16);
    await torus.change(() => torus.set("limit", "distance on screen"));
    const coarse = await torus.evaluate((c) => c.store.count);
    await torus.change(() => torus.set("pixels a point", 8));
    const ratio = (await torus.evaluate((c) => c.store.count)) / coarse;
    assert.ok(ratio > 3 && ratio < 5, `half the distance between points, ${ratio.toFixed(2)} times the points`);
    await torus.set("points", points);
    await torus.change(() => torus.set("limit", "number of points"));
    assert.equal(await torus.evaluate((c) => c.store.count), points);
  });

  it("puts points where the density says", async () => {
    await torus.change(() => torus.set("colours", "bends (curvature)"));
    await torus.settled();
    const even = { facing: await torus.evaluate(facing), bending: await torus.evaluate(bending) };
    await torus.change(() => torus.set("more at outlines", true));
    const outline = await torus.evaluate(facing);
    assert.ok(outline < 0.85 * even.facing, `|n·v| at the silhouette: ${outline}, before: ${even.facing}`);
    await torus.change(() => torus.set("more at outlines", false));
    await torus.change(() => torus.set("more at bends", "Gaussian"));
    const bent = await torus.evaluate(bending);
    assert.ok(bent > 1.2 * even.bending, `curvature of the points: ${bent}, before: ${even.bending}`);
    await torus.change(() => torus.set("more at bends", "no"));
    assert.equal(await torus.evaluate((c) => c.store.count), points);
    await torus.settled();
    assert.ok(Math.abs((await torus.evaluate(bending)) / even.bending - 1) < 1e-6, "the points of before");
    await torus.change(() => torus.set("colours", "the surface's own"));
  });

  it("samples as the paper does, too", async () => {
    for (const [sequence, count] of [
      ["jittered", 6000],
      ["regular", 7000],
      ["golden ratio", 8000],
    ]) {
      await torus.change(async () => {
        await torus.set("points are chosen", "along the curve (paper)");
        await torus.set("sequence", sequence);
        await torus.set("points", count);
      });
      assert.equal(await torus.evaluate((c) => c.store.count), count);
    }
    await torus.change(async () => {
      await torus.set("points are chosen", "by rank (progressive)");
      await torus.set("points", points);
    });
    assert.equal(await torus.evaluate((c) => c.store.count), points);
  });

  it("draws dots, colours, and on dark ground", async () => {
    await torus.settled();
    const discs = await torus.picture();
    await torus.page.keyboard.press("2");
    const dots = await torus.picture("dots.png");
    assertChanged(discs, dots, "dots");
    await torus.page.keyboard.press("1");
    let last = await torus.picture();
    assert.equal(countOf(difference(discs, last)), 0, "the picture of before");
    for (const colouring of ["shading", "normal", "curvature", "rank", "density"]) {
      const press = () => torus.page.keyboard.press("c");
      // What needs other numbers of the points asks for another view, once the picture is drawn.
      await (["shading", "normal"].includes(colouring) ? press() : torus.change(press));
      assert.equal(await torus.evaluate((c) => c.settings.colouring), colouring);
      const picture = await torus.picture(`${colouring}.png`);
      assertChanged(last, picture, colouring);
      last = picture;
    }
    await torus.page.keyboard.press("c");
    await torus.answered();
    await torus.page.keyboard.press("l");
    const dark = await torus.picture("dark.png");
    assert.ok(dark.data[0] + dark.data[1] + dark.data[2] < 200, "the corner is dark");
    assert.ok(discs.data[0] + discs.data[1] + discs.data[2] > 500, "the corner was light");
    await torus.screenshot("dark_page.png");
    await torus.page.keyboard.press("l");
  });
});
