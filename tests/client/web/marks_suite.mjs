// Annotations: places of the surface with texts.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, afterEach, before, describe, it } from "node:test";

import { countOf, decode, difference } from "./support/pictures.mjs";
import { faultsOf } from "./support/access.mjs";
import { openTorus } from "./support/shared_server.mjs";

const evil = '<img src=x onerror="window.broken = 1"> & more';

/// A place of the picture where the surface is.
const onSurface = (c) => {
  for (let x = 60; x < 400; x += 8) if (c.view.pick(x, 240) !== null) return [x + 40, 240];
  return null;
};

describe("annotations", () => {
  let torus;
  before(async () => (torus = await openTorus("points=3000", { viewport: { width: 1000, height: 480 } })));
  afterEach(() => torus.assertFine());
  after(() => torus.close());

  const labels = () => torus.page.locator(".marks > div");
  const rows = () => torus.page.locator(".mark-list .session");
  const field = () => torus.page.getByLabel(/^Annotation \d+$/);

  it("are added by a click, with a text that is never markup, in picture and panel", async () => {
    const before = await torus.picture();
    const place = await torus.evaluate(onSurface);
    await torus.page.keyboard.press("k");
    await torus.page.mouse.click(...place);
    await field().waitFor();
    assert.ok(await field().evaluate((input) => input === document.activeElement), "its text can be typed at once");
    await torus.page.keyboard.type(evil);
    assert.deepEqual(await faultsOf(torus), []);
    await torus.page.keyboard.press("Enter");
    await field().waitFor({ state: "hidden" });
    assert.equal(await labels().innerText(), `1\n${evil}`);
    assert.equal(await rows().locator("strong").textContent(), `1 · ${evil}`);
    assert.equal(await torus.page.locator(".marks img, .mark-list img").count(), 0);
    assert.equal(await torus.page.evaluate(() => window.broken), undefined);
    const { x, y } = await labels().boundingBox();
    assert.ok(Math.abs(x - 7 - place[0]) < 3 && Math.abs(y - 7 - place[1]) < 3, `the label is at ${x}, ${y}`);
    const dot = countOf(difference(before, await torus.picture("mark.png")));
    assert.ok(dot > 20 && dot < 400, `${dot} pixels are a dot`);
    await torus.screenshot("marks.png");
  });

  it("follow the camera, and are faint behind the surface", async () => {
    const before = await labels().boundingBox();
    await torus.change(() => torus.page.keyboard.press("ArrowLeft"));
    assert.notDeepEqual(await labels().boundingBox(), before);
    const camera = await torus.evaluate((c) => c.view.camera);
    const eye = camera.eye.map((value, k) => 2 * camera.target[k] - value);
    await torus.evaluate((c, other) => (c.view.camera = other), { ...camera, eye });
    await torus.page.locator(".marks .behind").waitFor();
    await torus.evaluate((c, other) => (c.view.camera = other), camera);
    await torus.page.locator(".marks .behind").waitFor({ state: "detached" });
  });

  it("are in the saved picture as on the page, however large it is", async () => {
    await torus.settled();
    const box = await labels().boundingBox();
    const shown = decode(await torus.page.screenshot());
    const without = await torus.picture();
    for (const scale of [1, 2]) {
      await torus.set("times as large", scale);
      const [download] = await Promise.all([torus.page.waitForEvent("download"), torus.page.keyboard.press("p")]);
      const saved = decode(readFileSync(await download.path()), `marks_saved_${scale}.png`);
      assert.equal(saved.width, scale * without.width);
      // The label's text is dark on its paper, and there is none beside it.
      const differs = (x, y) => {
        const [i, j] = [4 * (y * shown.width + x), 4 * (scale * y * saved.width + scale * x)];
        return [0, 1, 2].some((k) => Math.abs(shown.data[i + k] - saved.data[j + k]) > 60);
      };
      let wrong = 0;
      let all = 0;
      for (let y = Math.ceil(box.y) - 4; y < box.y + box.height + 4; ++y)
        for (let x = Math.ceil(box.x) - 4; x < box.x + box.width + 4; ++x, ++all) wrong += differs(x, y) ? 1 : 0;
      console.log(`# ${scale}: ${wrong} of ${all} pixels at the label differ from the page's`);
      assert.ok(wrong < 0.2 * all);
      if (scale > 1) continue;
      const drawn = countOf(difference(without, saved));
      assert.ok(drawn > 0.5 * box.width * box.height, `${drawn} pixels are the label`);
    }
    await torus.set("times as large", 1);
  });

  it("are added by keys alone, changed, kept by the address and removed", async () => {
    await torus.page.keyboard.press("k");
    const { marks } = await torus.evaluate((c) => c.settings);
    await torus.evaluate((c, place) => c.view.lookAt(place), marks[0].place); // so that there is surface in the middle
    await torus.until((c, place) => {
      const at = c.view.placeOf(place);
      return at !== null && Math.abs(at.x - c.view.cssSize.width / 2) < 1;
    }, marks[0].place);
    await torus.set("Annotate the middle");
    await field().waitFor();
    await torus.page.keyboard.type("second");
    await torus.page.keyboard.press("Enter");
    assert.equal(await rows().count(), 2);
    await torus.until(() => new URLSearchParams(location.hash.slice(1)).getAll("mark").length === 2);
    await torus.page.reload();
    await torus.until((c) => c.statistics !== null);
    assert.deepEqual(await labels().allInnerTexts(), [`1\n${evil}`, "2\nsecond"]);
    await torus.page.locator(".lil-gui .title", { hasText: "Annotations" }).click();
    await rows().nth(1).locator("button").first().click();
    await field().fill("third");
    await torus.page.keyboard.press("Enter");
    assert.equal(await rows().nth(1).locator("strong").textContent(), "2 · third");
    await torus.page.getByRole("button", { name: "Remove annotation 1" }).click();
    assert.deepEqual(await labels().allInnerTexts(), ["1\nthird"]);
    assert.deepEqual(await faultsOf(torus), []);
    await torus.set("Remove all annotations");
    assert.equal(await labels().count(), 0);
    await torus.until(() => !location.hash.includes("mark="));
  });
});
