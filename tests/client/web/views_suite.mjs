// From where the surface is seen: by name, by touch; and on which screens.

import assert from "node:assert/strict";
import { after, afterEach, before, describe, it } from "node:test";

import { boxOf, difference } from "./support/pictures.mjs";
import { openTorus } from "./support/shared_server.mjs";

const points = 3000;

/// Whether the camera looks along `direction`, with `up` up.
const looksAlong = (c, [direction, up]) => {
  const { eye, target, up: upwards } = c.view.camera;
  const away = target.map((value, k) => value - eye[k]);
  const cosine = away.reduce((sum, value, k) => sum + value * direction[k], 0) / Math.hypot(...away);
  return cosine > 0.9998 && up.every((value, k) => Math.abs(value - upwards[k]) < 1e-6);
};

async function assertWhole(torus) {
  const picture = await torus.picture();
  const { width, height } = picture;
  const box = boxOf(difference(picture, await torus.emptyPicture(), 0), width);
  assert.ok(box.left > 0 && box.top > 0 && box.right < width - 1 && box.bottom < height - 1, "nothing is cut off");
  assert.ok(box.right - box.left > 0.5 * width || box.bottom - box.top > 0.5 * height, "it fills the picture");
}

describe("the views that have names", () => {
  let torus;
  before(async () => (torus = await openTorus(`points=${points}`, { viewport: { width: 1100, height: 480 } })));
  afterEach(() => torus.assertFine());
  after(() => torus.close());

  it("are there by keys, by buttons and by the ends of the axes, and show the whole surface", async () => {
    const y = [0, 1, 0];
    const button = (name) => torus.page.getByRole("button", { name, exact: true }).click();
    for (const [go, direction] of [
      [() => torus.page.keyboard.press("4"), [0, 0, -1]],
      [() => torus.page.keyboard.press("5"), [-1, 0, 0]],
      [() => torus.page.keyboard.press("6"), [0, -1, 0]],
      [() => button("Side"), [-1, 0, 0]],
      [() => button("Front"), [0, 0, -1]],
      [() => torus.page.locator(".axes .negative.x").dispatchEvent("click"), [1, 0, 0]],
      [() => torus.page.locator(".axes .positive.y").dispatchEvent("click"), [0, -1, 0]],
    ]) {
      await go();
      await torus.until(looksAlong, [direction, y]);
      await torus.settled();
      await assertWhole(torus);
    }
    await torus.page.keyboard.press("Home");
    await torus.until(looksAlong, [[-0.55, -0.35, -1].map((value) => value / Math.hypot(0.55, 0.35, 1)), y]);
    await torus.settled();
    await torus.screenshot("views.png");
  });

  it("follow the axis that points up, which the address keeps", async () => {
    const z = [0, 0, 1];
    await torus.change(() => torus.set("axis that points up", "Z"));
    await torus.page.keyboard.press("4");
    await torus.until(looksAlong, [[0, 1, 0], z]);
    await torus.page.keyboard.press("6");
    await torus.until(looksAlong, [[0, 0, -1], z]);
    await torus.until((c) => {
      const kept = new URLSearchParams(location.hash.slice(1)).get("camera").split(",").map(Number);
      return location.hash.includes("up=z") && c.view.camera.eye.every((value, k) => Math.abs(value - kept[k]) < 1e-6);
    });
    await torus.page.reload();
    await torus.until((c) => c.statistics !== null);
    await torus.until(looksAlong, [[0, 0, -1], z]);
    await torus.change(() => torus.set("axis that points up", "Y"));
  });

  it("have the angle of view that is set, and leave the surface as large", async () => {
    await torus.settled();
    const height = (c) => {
      const { eye, target, fov } = c.view.camera;
      return Math.hypot(...eye.map((value, k) => value - target[k])) * Math.tan((fov * Math.PI) / 360);
    };
    const before = await torus.evaluate(height);
    await torus.change(() => torus.set("angle of view", 75));
    assert.equal(await torus.evaluate((c) => c.view.camera.fov), 75);
    assert.ok(Math.abs((await torus.evaluate(height)) / before - 1) < 1e-9);
    await torus.change(() => torus.evaluate((c) => (c.view.camera = { ...c.view.camera, fov: 30 })));
    assert.equal(await torus.evaluate((c) => c.settings.fieldOfView), 30, "the panel follows the camera");
  });

  it("have parallel rays where that is set: nothing is larger for being near", async () => {
    await torus.page.keyboard.press("4");
    await torus.until(looksAlong, [
      [0, 0, -1],
      [0, 1, 0],
    ]);
    await torus.settled();
    await torus.change(() => torus.page.keyboard.press("7"));
    assert.equal(await torus.evaluate((c) => c.view.camera.orthographic), true);
    await torus.page.keyboard.press("f");
    await torus.settled();
    await assertWhole(torus);
    // Places of the surface are as far across as their pixels, whatever their depths.
    const places = await torus.evaluate((c) => {
      const { eye, target, fov } = c.view.camera;
      const unit = (2 * (eye[2] - target[2]) * Math.tan((fov * Math.PI) / 360)) / c.view.cssSize.height;
      const canvas = document.querySelector("canvas");
      const found = [];
      for (let x = 0; x < canvas.clientWidth; x += 10) {
        for (let y = 0; y < c.view.cssSize.height; y += 10) {
          const pick = c.view.pick(x, y);
          if (pick === null) continue;
          const across = target[0] + (x - canvas.clientWidth / 2) * unit;
          const up = target[1] - (y - c.view.cssSize.height / 2) * unit;
          found.push([Math.hypot(pick.point[0] - across, pick.point[1] - up) / unit, pick.point[2]]);
        }
      }
      return found;
    });
    const depths = places.map(([, depth]) => depth);
    assert.ok(Math.max(...depths) - Math.min(...depths) > 0.2, "places of many depths");
    assert.ok(Math.max(...places.map(([away]) => away)) < 8.1, "within the reach of the pointer");
    assert.ok(places.filter(([away]) => away < 0.01).length > 0.9 * places.length);
    await torus.screenshot("orthographic.png");
    const height = (c) => Math.hypot(...c.view.camera.eye.map((value, k) => value - c.view.camera.target[k]));
    const before = await torus.evaluate(height);
    await torus.page.mouse.move(200, 240);
    await torus.change(() => torus.page.mouse.wheel(0, -240));
    assert.ok((await torus.evaluate(height)) < 0.8 * before, "the wheel makes it larger");
    await torus.until(() => location.hash.includes("projection=orthographic"));
    await torus.page.reload();
    await torus.until((c) => c.statistics !== null);
    await torus.settled();
    assert.equal(await torus.evaluate((c) => c.view.camera.orthographic), true, "the address keeps it");
    await torus.change(() => torus.set("projection", "perspective"));
    assert.equal(await torus.evaluate((c) => c.view.camera.orthographic), false);
    await torus.page.keyboard.press("f");
    await torus.settled();
  });

  it("may be of nothing, which is no error", async () => {
    const camera = await torus.evaluate((c) => c.view.camera);
    const away = { ...camera, target: camera.eye.map((value, k) => 2 * value - camera.target[k]) };
    await torus.evaluate((c, turned) => (c.view.camera = turned), away);
    const hint = torus.page.getByText("Nothing of the surface is in view");
    await hint.waitFor();
    await torus.screenshot("nothing.png");
    assert.equal(await torus.page.locator(".notice, .failure").count(), 0);
    await torus.page.locator(".hint button").click();
    await hint.waitFor({ state: "hidden" });
    await torus.evaluate((c, before) => (c.view.camera = before), camera);
    await torus.settled();
  });

  it("are passed on by a link", async () => {
    await torus.context.grantPermissions(["clipboard-read", "clipboard-write"]);
    await torus.page.keyboard.press("y");
    await torus.page.getByText("was copied").waitFor();
    const link = await torus.page.evaluate(() => navigator.clipboard.readText());
    assert.equal(link, torus.page.url());
    assert.match(link, /session=.*camera=/);
  });

  it("fill the whole screen", async () => {
    await torus.page.keyboard.press("g");
    await torus.page.waitForFunction(() => document.fullscreenElement !== null);
    await torus.page.keyboard.press("g");
    await torus.page.waitForFunction(() => document.fullscreenElement === null);
  });
});

describe("a finger, and two", () => {
  it("turn, move and zoom", async () => {
    const torus = await openTorus(`points=${points}`, { hasTouch: true, isMobile: true, viewport: { width: 400, height: 500 } });
    const session = await torus.context.newCDPSession(torus.page);
    const touch = async (...steps) => {
      for (const [i, fingers] of steps.entries()) {
        const touchPoints = fingers.map(([x, y], id) => ({ x, y, id }));
        await session.send("Input.dispatchTouchEvent", { type: i === 0 ? "touchStart" : "touchMove", touchPoints });
      }
      await session.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
    };
    const distanceOf = ({ eye, target }) => Math.hypot(...eye.map((value, k) => value - target[k]));
    const from = await torus.evaluate((c) => c.view.camera);
    await torus.change(() => touch([[200, 250]], [[215, 255]], [[240, 260]]));
    const turned = await torus.evaluate((c) => c.view.camera);
    assert.notDeepEqual(turned.eye, from.eye);
    await torus.change(() =>
      touch(
        [
          [180, 250],
          [220, 250],
        ],
        [
          [170, 250],
          [230, 250],
        ],
        [
          [160, 250],
          [240, 250],
        ],
      ),
    );
    const near = await torus.evaluate((c) => c.view.camera);
    assert.ok(distanceOf(near) < 0.7 * distanceOf(turned), "nearer");
    await torus.change(() =>
      touch(
        [
          [180, 250],
          [220, 250],
        ],
        [
          [180, 280],
          [220, 280],
        ],
        [
          [180, 310],
          [220, 310],
        ],
      ),
    );
    const moved = await torus.evaluate((c) => c.view.camera);
    assert.notDeepEqual(moved.target, near.target);
    assert.ok(Math.abs(distanceOf(moved) / distanceOf(near) - 1) < 0.01, "as near");
    await torus.screenshot("touch.png");
    await torus.close();
  });
});

describe("a dense screen", () => {
  it("gets all its pixels, also after a zoom, up to the bound that is set", async () => {
    const torus = await openTorus(`points=${points}`, { viewport: { width: 320, height: 240 }, deviceScaleFactor: 2 });
    const isSharp = (c, [width, ratio]) => {
      const canvas = document.querySelector("canvas");
      return canvas.clientWidth === width && canvas.width === ratio * width && c.view.size.width === ratio * width;
    };
    await torus.until(isSharp, [320, 2]);
    await torus.screenshot("dense.png");
    const session = await torus.context.newCDPSession(torus.page);
    // As a zoom of the page does: fewer CSS pixels, and more pixels of the screen for each.
    const zoom = (factor) =>
      session.send("Emulation.setDeviceMetricsOverride", {
        width: 320 / factor,
        height: 240 / factor,
        deviceScaleFactor: factor,
        mobile: false,
      });
    await zoom(2);
    await torus.until(isSharp, [160, 2]);
    await zoom(4);
    await torus.until(isSharp, [80, 2]);
    await torus.set("sharpness", 4);
    await torus.until(isSharp, [80, 4]);
    await torus.close();
  });
});
