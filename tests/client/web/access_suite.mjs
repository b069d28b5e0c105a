// The page for those who use keys, fingers, or have it read out.

import assert from "node:assert/strict";
import { after, afterEach, before, describe, it } from "node:test";

import { WatchedPage } from "./support/browser.mjs";
import { faultsOf } from "./support/access.mjs";
import { Server } from "./support/server.mjs";
import { openTorus } from "./support/shared_server.mjs";

const fingertip = 44; // CSS pixels

/// Unfolds all of the panel.
const unfold = () => {
  for (const title of document.querySelectorAll(".lil-gui .title[aria-expanded='false']")) title.click();
};

describe("the page, read out", () => {
  let torus;
  before(async () => (torus = await openTorus("points=1000", { viewport: { width: 1200, height: 900 } })));
  afterEach(() => torus.assertFine());
  after(() => torus.close());

  it("has names, roles and contrast for all that it shows, on light and on dark ground", async () => {
    assert.deepEqual(await faultsOf(torus), []);
    await torus.evaluate(unfold);
    await torus.page.keyboard.press("m");
    await torus.page.keyboard.press("t");
    await torus.until((c) => c.mesh !== null && c.isMeshCurrent);
    await torus.page.locator(".lil-gui.transition").waitFor({ state: "detached" });
    assert.deepEqual(await faultsOf(torus), []);
    await torus.page.keyboard.press("l");
    assert.deepEqual(await faultsOf(torus), []);
    await torus.page.keyboard.press("l");
    await torus.page.keyboard.press("?");
    assert.deepEqual(await faultsOf(torus), []);
    await torus.page.keyboard.press("Escape");
    for (const key of ["t", "m"]) await torus.page.keyboard.press(key);
  });

  it("has an invitation and a form for the token that can be read out, too", async () => {
    const server = await Server.start("--max-curve-vertices", "0");
    const page = await WatchedPage.open(server.url);
    await page.page.getByText("Drop a mesh here").waitFor();
    assert.deepEqual(await faultsOf(page), []);
    await page.close();
    await server.stop();
  });

  it("says what keys have changed", async () => {
    const spoken = torus.page.locator(".unseen[role=status]");
    await torus.page.keyboard.press("o");
    assert.equal(await spoken.textContent(), "dark edges: off");
    await torus.page.keyboard.press("o");
    assert.equal(await spoken.textContent(), "dark edges: on");
  });

  it("is reached by the tabulator, each control once", async () => {
    await torus.page.evaluate(() => document.querySelector("canvas").focus());
    const all = await torus.page.evaluate(
      () =>
        [...document.querySelectorAll("button, input, select, summary, [role=slider]")].filter(
          (each) => each.checkVisibility() && each.type !== "file" && each.closest("svg") === null,
        ).length,
    );
    const seen = await torus.page.evaluateHandle(() => new Set());
    for (let i = 0; i < all + 2; ++i) {
      await torus.page.keyboard.press("Tab");
      await seen.evaluate((set) => set.add(document.activeElement));
    }
    const reached = await seen.evaluate(
      (set) => [...set].filter((each) => each !== document.body && each.tagName !== "CANVAS").length,
    );
    assert.equal(reached, all);
  });

  it("has sliders for keys, by equal factors where numbers go far, which do not turn the picture", async () => {
    const eye = await torus.evaluate((c) => c.view.camera.eye);
    const slider = torus.page.getByRole("slider", { name: "points", exact: true });
    await slider.focus();
    await torus.change(() => torus.page.keyboard.press("ArrowRight"));
    assert.equal(await torus.evaluate((c) => c.settings.points), 1100);
    assert.equal(await slider.getAttribute("aria-valuenow"), "1100");
    await torus.change(() => torus.page.keyboard.press("PageUp"));
    assert.equal(await torus.evaluate((c) => c.settings.points), 3500);
    const { x, y, width, height } = await slider.boundingBox();
    await torus.change(() => torus.page.mouse.click(x + width / 3, y + height / 2));
    const clicked = await torus.evaluate((c) => c.settings.points);
    assert.ok(clicked >= 9000 && clicked <= 11_000, `a third of the slider is a third of its decades: ${clicked}`);
    const { width: filled } = await slider.locator(".fill").boundingBox();
    assert.ok(Math.abs(filled / width - 1 / 3) < 0.03, `${filled} of ${width} pixels are filled`);
    await torus.change(() => torus.page.keyboard.press("Home"));
    assert.equal(await torus.evaluate((c) => c.settings.points), 1000);
    assert.deepEqual(await torus.evaluate((c) => c.view.camera.eye), eye);
  });
});

describe("the page under a finger", () => {
  it("has nothing to touch that is smaller than a fingertip", async () => {
    const torus = await openTorus("points=1000", { hasTouch: true, isMobile: true, viewport: { width: 390, height: 800 } });
    await torus.screenshot("phone.png");
    await torus.evaluate(unfold);
    await torus.screenshot("phone_panel.png");
    const small = await torus.page.evaluate((least) => {
      const all = [
        ...document.querySelectorAll("button, select, summary, .lil-gui .controller, .slider, .lil-gui input[type=text]"),
      ];
      return all
        .filter((each) => each.checkVisibility())
        .map((each) => ({ text: each.textContent.slice(0, 40), height: each.getBoundingClientRect().height }))
        .filter(({ height }) => height > 0 && height < least);
    }, fingertip - 0.01); // places are multiples of 1/64 of a pixel, and heights differences of them
    assert.deepEqual(small, []);
    assert.deepEqual(await faultsOf(torus), []);
    await torus.close();
  });
});
