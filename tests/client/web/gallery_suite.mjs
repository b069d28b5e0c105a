// The list of sessions has pictures of those that were shown.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, it } from "node:test";

import { faultsOf } from "./support/access.mjs";
import { WatchedPage } from "./support/browser.mjs";
import { ball, cube } from "./support/meshes.mjs";
import { decode } from "./support/pictures.mjs";
import { Server, temporaryFolder } from "./support/server.mjs";

describe("two sessions", () => {
  let server;
  let page;
  before(async () => {
    const folder = temporaryFolder();
    const meshes = { ball, cube };
    for (const [name, make] of Object.entries(meshes)) writeFileSync(join(folder, `${name}.off`), make());
    server = await Server.start(
      "--open",
      join(folder, "ball.off"),
      "--open",
      join(folder, "cube.off"),
      "--max-curve-vertices",
      "0",
    );
    page = await WatchedPage.open(`${server.url}#points=1000`, { viewport: { width: 1000, height: 700 } });
    await page.settled();
  });
  after(async () => {
    await page?.close();
    await server?.stop();
  });

  it("have pictures in the list once another was shown, and after the page is loaded again", async () => {
    const first = await page.evaluate((c) => c.session.sessionId);
    assert.equal(await page.page.locator(".session img:visible").count(), 0);
    await page.page.locator(".session button:first-child:not([aria-current])").click();
    await page.until((c, id) => c.session.sessionId !== id, first);
    await page.settled();
    const picture = page.page.locator(`.session button[title="${first}"] img`);
    await picture.waitFor({ state: "visible" });
    assert.deepEqual(await picture.evaluate(({ naturalWidth, naturalHeight }) => [naturalWidth, naturalHeight]), [128, 96]);
    const box = await picture.boundingBox();
    const { width, data } = decode(await page.page.screenshot({ clip: box }), "thumbnail.png");
    const at = (x, y) => [...data.subarray(4 * (y * width + x), 4 * (y * width + x) + 3)];
    assert.ok(Math.abs(at(32, 24)[2] - at(4, 4)[2]) > 30, `the surface is in the middle: ${at(32, 24)} beside ${at(4, 4)}`);
    await page.screenshot("gallery.png");
    assert.deepEqual(await faultsOf(page), []);
    await page.page.reload();
    await page.until((c) => c.statistics !== null);
    await picture.waitFor({ state: "visible" });
  });
});
