// The tools: brush, frozen camera, split view, measuring, files, the address; other people's pages.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, afterEach, before, describe, it } from "node:test";

import { WatchedPage } from "./support/browser.mjs";
import { boxOf, countOf, decode, difference } from "./support/pictures.mjs";
import { openTorus, sharedServer } from "./support/shared_server.mjs";

const points = 5000;

/// Points of the page on the surface, near the middle of the picture's left and right half: [x, y, point].
const surfacePoints = (c) => {
  const found = [];
  for (const [from, to] of [
    [60, 300],
    [340, 580],
  ]) {
    for (let x = from; x < to; x += 8) {
      const pick = c.view.pick(x, 240);
      if (pick === null) continue;
      found.push([x, 240, pick.point]);
      break;
    }
  }
  return found;
};

/// Sums that no two sets of points have in common, but for the lattices their positions were rounded to.
const fingerprint = (c) => {
  let sum = 0;
  for (const slot of c.store.order()) {
    for (let k = 0; k < 4; ++k) sum += (k + 1) * c.store.positions[4 * slot + k] ** 2;
  }
  return [c.store.count, sum];
};

/// Asserts that both fingerprints are of the same points: each frame's positions are rounded to what its own view resolves.
const assertSame = ([count, sum], [wantedCount, wantedSum], what) => {
  assert.equal(count, wantedCount, what);
  assert.ok(Math.abs(sum / wantedSum - 1) < 1e-4, `${what}: ${sum}, and not ${wantedSum}`);
};

const within = (c, { centre, radius }) => {
  let count = 0;
  for (const slot of c.store.order()) {
    const d = centre.map((value, k) => value - c.store.origin[k] - c.store.positions[4 * slot + k]);
    if (Math.hypot(...d) < radius) ++count;
  }
  return count;
};

describe("the tools", () => {
  let torus;
  before(async () => (torus = await openTorus()));
  afterEach(() => torus.assertFine());
  after(() => torus.close());

  it("paints density with the brush, and takes it back", async () => {
    const even = await torus.evaluate(fingerprint);
    const [[x, y]] = await torus.evaluate(surfacePoints);
    await torus.set("radius, % of size", 6);
    await torus.page.keyboard.press("b");
    const counts = await torus.evaluate((c) => c.view.camera);
    await torus.page.mouse.move(x + 12, y);
    await torus.change(() =>
      torus.drag([
        [x + 12, y],
        [x + 14, y + 40],
      ]),
    );
    assert.deepEqual(await torus.evaluate((c) => c.view.camera), counts, "the picture does not turn");
    const dabs = await torus.evaluate((c) => c.settings.dabs);
    assert.ok(dabs.length >= 1);
    const painted = await torus.evaluate(within, dabs[0]);
    await torus.page.mouse.move(5, 5); // the brush itself is not to be seen
    const traced = await torus.picture("trace.png");
    await torus.page.keyboard.press("b");
    const trace = countOf(difference(traced, await torus.picture()));
    await torus.page.keyboard.press("b");
    assert.ok(trace > 500 && trace < 0.2 * traced.width * traced.height, `${trace} pixels show what was painted`);
    await torus.page.keyboard.press("2"); // dots show the density
    await torus.picture("brush.png");
    await torus.page.keyboard.press("1");
    assert.equal(await torus.evaluate((c) => c.store.count), points);
    await torus.change(() => torus.page.keyboard.press("Control+z"));
    await torus.settled();
    const before = await torus.evaluate(within, dabs[0]);
    assert.ok(painted > 2 * before && before > 0, `${painted} points under the brush, ${before} without it`);
    assertSame(await torus.evaluate(fingerprint), even, "the points of before");
    await torus.page.keyboard.press("b");
  });

  it("keeps the points of a frozen camera while it is looked at from elsewhere", async () => {
    const view = await torus.evaluate((c) => c.view.camera);
    await torus.page.keyboard.press("z");
    await torus.settled();
    const [look, sum, picture] = [await torus.evaluate((c) => c.look), await torus.evaluate(fingerprint), await torus.picture()];
    await torus.drag([
      [320, 20],
      [480, 60],
    ]);
    await torus.answered();
    assert.notDeepEqual(await torus.evaluate((c) => c.view.camera), view);
    assert.equal(await torus.evaluate((c) => c.look), look, "no view is asked for");
    assert.deepEqual(await torus.evaluate(fingerprint), sum);
    const aside = await torus.picture("frozen.png");
    assert.ok(countOf(difference(picture, aside)) > 0.02 * aside.width * aside.height, "the picture has changed");
    await torus.change(() => torus.page.keyboard.press("z"));
    const moved = await torus.evaluate(fingerprint);
    assert.ok(Math.abs(moved[1] / sum[1] - 1) > 1e-3, `points for the camera of now: ${moved} and ${sum}`);
  });

  it("cuts off what discs reach out of a frozen camera's picture", async () => {
    const view = await torus.evaluate((c) => c.view.camera);
    const near = { ...view, eye: view.eye.map((x, k) => view.target[k] + 0.4 * (x - view.target[k])) };
    await torus.change(() => torus.set("points are chosen", "along the curve (paper)")); // which has points for any view at once
    await torus.change(() => torus.evaluate((c, camera) => (c.view.camera = camera), near));
    await torus.set("size of discs", 3);
    await torus.page.keyboard.press("z");
    await torus.answered();
    // From the same place with a wider angle, the frozen picture is the middle of this one.
    const wide = (2 * Math.atan(2 * Math.tan((view.fov * Math.PI) / 360)) * 180) / Math.PI;
    await torus.evaluate((c, camera) => (c.view.camera = camera), { ...near, fov: wide });
    const picture = await torus.picture();
    const { width, height } = picture;
    const { left, top, right, bottom } = boxOf(difference(picture, await torus.emptyPicture()), width);
    assert.ok(left >= width / 4 - 2 && right < 0.75 * width + 2, `from ${left} to ${right} of ${width} pixels`);
    assert.ok(top >= height / 4 - 2 && bottom < 0.75 * height + 2, `from ${top} to ${bottom} of ${height} pixels`);
    assert.ok(bottom - top > 0.45 * height, "the surface goes from border to border");
    await torus.page.keyboard.press("z");
    await torus.set("size of discs", 1);
    await torus.change(() => torus.evaluate((c, camera) => (c.view.camera = camera), view));
    await torus.change(() => torus.set("points are chosen", "by rank (progressive)"));
  });

  it("shows uniform points beside, as many", async () => {
    await torus.settled();
    const single = await torus.evaluate(fingerprint);
    await torus.change(() => torus.page.keyboard.press("v"));
    await torus.until((c, count) => c.uniformStore?.count === count, points);
    await torus.settled();
    const sum = await torus.evaluate(fingerprint);
    const picture = await torus.picture("split.png");
    const mask = difference(picture, await torus.emptyPicture(), 0);
    const halves = [0, 0];
    mask.forEach((value, i) => (halves[i % picture.width < picture.width / 2 ? 0 : 1] += value));
    assert.ok(halves[0] > 5000 && halves[1] > 5000, `pixels of the surface in both halves: ${halves}`);
    assert.ok(Math.abs(halves[0] / halves[1] - 1) < 0.05, "of the same size");
    await torus.screenshot("split_page.png");
    const camera = await torus.evaluate((c) => c.view.camera);
    await torus.change(() => torus.page.keyboard.press("ArrowLeft"));
    await torus.change(() => torus.evaluate((c, before) => (c.view.camera = before), camera));
    await torus.settled();
    assertSame(await torus.evaluate(fingerprint), sum, "the points of before");
    await torus.change(() => torus.page.keyboard.press("v"));
    await torus.until((c) => c.uniformStore === null);
    await torus.settled();
    assertSame(await torus.evaluate(fingerprint), single, "the points of one picture");
  });

  it("cuts the surface open", async () => {
    const whole = await torus.picture();
    await torus.change(() => torus.set("cut across", "Z"));
    await torus.settled();
    const open = await torus.picture("section.png");
    assert.ok(countOf(difference(whole, open)) > 0.02 * whole.width * whole.height, "what was behind is to be seen");
    const heights = await torus.evaluate((c) => {
      const found = [];
      for (let x = 20; x < 620; x += 20) for (let y = 20; y < 460; y += 20) found.push(c.view.pick(x, y)?.point[2] ?? 0);
      return found;
    });
    assert.ok(Math.max(...heights) < 0.1 && Math.min(...heights) < -0.1, `what is picked lies below ${Math.max(...heights)}`); // a disc's radius
    await torus.change(() => torus.set("cut across", "no"));
    await torus.settled();
    assert.ok(countOf(difference(whole, await torus.picture())) < 0.002 * whole.width * whole.height, "it is whole again");
  });

  it("folds its figures down to the state", async () => {
    const figures = torus.page.locator(".hud dl");
    await torus.page.keyboard.press("i");
    await figures.waitFor({ state: "hidden" });
    assert.equal(await torus.page.locator(".hud .state").innerText(), "live");
    await torus.page.locator(".hud summary").click();
    await figures.waitFor({ state: "visible" });
  });

  it("measures between two clicks", async () => {
    await torus.page.keyboard.press("f");
    await torus.answered();
    const [[ax, ay, a], [bx, by, b]] = await torus.evaluate(surfacePoints);
    await torus.page.keyboard.press("m");
    await torus.page.mouse.click(ax, ay);
    await torus.page.mouse.click(bx, by);
    const row = torus.page.locator(".hud dd.distance");
    await row.waitFor({ state: "visible" });
    const distance = Number.parseFloat(await row.textContent());
    const wanted = Math.hypot(...a.map((value, k) => value - b[k]));
    assert.ok(Math.abs(distance / wanted - 1) < 0.01, `${distance}, and not ${wanted}`);
    await torus.screenshot("measure.png");
    await torus.page.keyboard.press("o"); // another setting leaves the line alone
    await torus.page.keyboard.press("o");
    assert.ok(await row.isVisible());
    await torus.set("unit of the file", "mm");
    assert.match(await row.textContent(), /^[\d.]+\u00a0mm$/);
    assert.match(await torus.page.locator(".scale").innerText(), /mm$/);
    await torus.until(() => location.hash.includes("unit=mm"));
    await torus.set("unit of the file", "not known");
    await torus.page.keyboard.press("m");
    await row.waitFor({ state: "hidden" });
  });

  it("measures angles by three clicks, and areas of polygons until they are closed", async () => {
    const [[ax, ay, a], [bx, by, b]] = await torus.evaluate(surfacePoints);
    const [cx, cy, c] = await torus.evaluate((handle) => {
      for (let y = 40; y < 440; y += 8) {
        const pick = handle.view.pick(320, y);
        if (pick !== null) return [320, y + 8, handle.view.pick(320, y + 8).point];
      }
      return null;
    });
    const minus = (p, q) => p.map((value, k) => value - q[k]);
    const [u, v] = [minus(a, b), minus(c, b)];
    const cosine = u.reduce((sum, value, k) => sum + value * v[k], 0) / Math.hypot(...u) / Math.hypot(...v);
    await torus.page.keyboard.press("m");
    await torus.page.keyboard.press("j");
    for (const [x, y] of [
      [ax, ay],
      [bx, by],
      [cx, cy],
    ]) {
      await torus.page.mouse.click(x, y);
    }
    const value = async (kind) => Number.parseFloat(await torus.page.locator(`.hud dd.${kind}`).textContent());
    await torus.page.locator(".hud dd.angle").waitFor({ state: "visible" });
    const wanted = (Math.acos(cosine) * 180) / Math.PI;
    assert.ok(Math.abs((await value("angle")) - wanted) < 0.2, `${await value("angle")}°, and not ${wanted}°`);
    await torus.page.keyboard.press("j");
    await torus.page.locator(".hud dd.angle").waitFor({ state: "hidden" });
    for (const [x, y] of [
      [ax, ay],
      [bx, by],
      [cx, cy],
      [ax + 3, ay],
    ]) {
      await torus.page.mouse.click(x, y);
    }
    const area = 0.5 * Math.hypot(...u) * Math.hypot(...v) * Math.sqrt(1 - cosine * cosine);
    assert.ok(Math.abs((await value("area")) / area - 1) < 0.01, `${await value("area")}, and not ${area}`);
    await torus.screenshot("measure_area.png");
    await torus.until(() => location.hash.includes("measure=area"));
    await torus.page.keyboard.press("j");
    await torus.page.keyboard.press("m");
  });

  it("saves the points as PLY", async () => {
    const [download] = await Promise.all([torus.page.waitForEvent("download"), torus.page.keyboard.press("x")]);
    assert.equal(download.suggestedFilename(), `torus-${points}.ply`);
    const bytes = readFileSync(await download.path());
    const end = bytes.indexOf("end_header\n") + "end_header\n".length;
    const header = bytes.subarray(0, end).toString();
    assert.match(header, new RegExp(`element vertex ${points}\n`));
    const read = { float: "readFloatLE", double: "readDoubleLE", uchar: "readUInt8", uint: "readUInt32LE" };
    const sizes = { float: 4, double: 8, uchar: 1, uint: 4 };
    const properties = [...header.matchAll(/property (\w+) (\w+)/g)].map(([, type, name]) => ({ type, name }));
    const stride = properties.reduce((sum, { type }) => sum + sizes[type], 0);
    assert.equal(bytes.length, end + points * stride);
    for (let i = 0; i < points; ++i) {
      let at = end + i * stride;
      const value = {};
      for (const { type, name } of properties) {
        value[name] = bytes[read[type]](at);
        at += sizes[type];
      }
      const { x, y, z, nx, ny, nz, radius } = value;
      const around = Math.hypot(Math.hypot(x, y) - 1, z); // from the middle of the torus's tube
      assert.ok(around > 0.3 && around < 0.5 && radius > 0 && Math.abs(Math.hypot(nx, ny, nz) - 1) < 0.02, `point ${i}`);
    }
  });

  it("saves the picture", async () => {
    const [download] = await Promise.all([torus.page.waitForEvent("download"), torus.page.keyboard.press("p")]);
    assert.match(download.suggestedFilename(), /\.png$/);
    const { width, height } = decode(readFileSync(await download.path()));
    assert.deepEqual([width, height], [640, 480]);
    await torus.set("times as large", 3);
    const [large] = await Promise.all([torus.page.waitForEvent("download"), torus.page.keyboard.press("p")]);
    const picture = decode(readFileSync(await large.path()));
    assert.deepEqual([picture.width, picture.height], [1920, 1440]);
    await torus.until(() => document.querySelector("canvas").width === 640); // the page is as before
    await torus.set("times as large", 1);
  });

  it("lists its keys", async () => {
    const list = torus.page.getByRole("dialog", { name: "Keys" });
    await torus.page.keyboard.press("?");
    await list.waitFor({ state: "visible" });
    await torus.screenshot("keys.png");
    assert.match(await list.innerText(), /turn[\s\S]*nearer, farther/);
    assert.ok(await list.evaluate((element) => element === document.activeElement), "it has the focus");
    const { mode } = await torus.evaluate((c) => c.settings);
    await torus.page.keyboard.press("2");
    assert.equal(await torus.evaluate((c) => c.settings.mode), mode, "other keys do nothing meanwhile");
    await torus.page.keyboard.press("Escape");
    await list.waitFor({ state: "hidden" });
  });

  it("obeys keys while a checkbox of the panel has the focus, and a key that is held down only once", async () => {
    const press = (row, repeat = false) =>
      torus.evaluate(
        (c, [label, repeated]) => {
          const rows = [...document.querySelectorAll(".lil-gui .controller")];
          const input = rows.find(({ textContent }) => textContent.startsWith(label)).querySelector("input");
          input.dispatchEvent(new KeyboardEvent("keydown", { key: "o", repeat: repeated, bubbles: true, cancelable: true }));
          return c.settings.edl;
        },
        [row, repeat],
      );
    const { edl } = await torus.evaluate((c) => c.settings);
    assert.equal(await press("dark edges"), !edl);
    assert.equal(await press("dark edges", true), !edl, "it is still held down");
    assert.equal(await press("points"), !edl, "a field keeps its keys");
    assert.equal(await press("dark edges"), edl);
  });

  it("keeps camera and settings in the address", async () => {
    await torus.change(() =>
      torus.drag([
        [320, 20],
        [400, 90],
      ]),
    );
    await torus.change(() => torus.set("points", 4000));
    await torus.change(() => torus.set("more at outlines", true));
    const [camera, settings] = [await torus.evaluate((c) => c.view.camera), await torus.evaluate((c) => c.settings)];
    await torus.until((c, eye) => {
      const kept = new URLSearchParams(location.hash.slice(1)).get("camera")?.split(",").map(Number) ?? [];
      return location.hash.includes("silhouette=1") && Math.hypot(...eye.map((value, k) => value - kept[k])) < 1e-4;
    }, camera.eye);
    await torus.page.reload();
    await torus.until((c) => c.statistics !== null);
    await torus.answered();
    assert.deepEqual(await torus.evaluate((c) => c.settings), settings);
    const again = await torus.evaluate((c) => c.view.camera);
    for (const part of ["eye", "target", "up"]) {
      assert.ok(Math.hypot(...camera[part].map((value, k) => value - again[part][k])) < 1e-4, part);
    }
    assert.equal(await torus.evaluate((c) => c.store.count), 4000);
  });
});

describe("two pictures of an odd width", () => {
  it("are of the same size", async () => {
    const torus = await openTorus("points=1000&split=1", { viewport: { width: 641, height: 300 } });
    await torus.until((c) => c.uniformStore?.count === 1000);
    const widths = await torus.evaluate((c) => {
      void c.view.screenshot(); // draws at once
      return [document.querySelector("canvas").width, c.view.size.width];
    });
    assert.equal(widths[0], 2 * widths[1]);
    await torus.close();
  });
});

describe("a graphics card that is lost", () => {
  it("is told, and the picture is there again once it is back", async () => {
    const torus = await openTorus(`points=${points}`);
    torus.expect(/context.?lost/i); // said by Chromium itself
    const before = await torus.picture();
    await torus.evaluate(() => {
      window.loser = document.querySelector("canvas").getContext("webgl2").getExtension("WEBGL_lose_context");
      window.loser.loseContext();
    });
    const banner = torus.page.getByRole("alert");
    await banner.getByText("graphics card was lost").waitFor();
    assert.equal(await torus.evaluate((c) => c.view.uploadNow()), 0);
    await torus.evaluate(() => window.loser.restoreContext());
    await banner.waitFor({ state: "hidden" });
    await torus.settled();
    assert.equal(countOf(difference(before, await torus.picture("restored.png"))), 0);
    await torus.close();
  });
});

describe("another page", () => {
  it("has the session in its own scene", async () => {
    const { url } = await sharedServer();
    const example = await WatchedPage.open(`${url}example.html`, { viewport: { width: 320, height: 240 } });
    const isDrawn = async () => {
      const { data, width, height } = decode(await example.page.screenshot(), "example.png");
      let bright = 0;
      for (let i = 0; i < width * height; ++i) if (data[4 * i] + data[4 * i + 1] + data[4 * i + 2] > 150) ++bright;
      return bright > 0.03 * width * height;
    };
    while (!(await isDrawn())) example.assertFine(); // until the time of the test is over
    await example.close();
  });
});
