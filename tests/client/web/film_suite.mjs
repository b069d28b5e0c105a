// Films: a turn, and the way past views, as files that play.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, afterEach, before, describe, it } from "node:test";

import { openTorus } from "./support/shared_server.mjs";

const pictures = 30;

/// Plays a film in the page. Returns what it says of itself, and its pictures at some shares of its length, small and grey.
async function play(page, bytes, shares) {
  return page.evaluate(
    async ([base64, at]) => {
      const film = await (await fetch(`data:video/webm;base64,${base64}`)).blob();
      const video = Object.assign(document.createElement("video"), { muted: true, src: URL.createObjectURL(film) });
      await new Promise((resolve, reject) => {
        video.onloadeddata = resolve;
        video.onerror = () => reject(new Error(video.error.message));
      });
      const small = Object.assign(document.createElement("canvas"), { width: 64, height: 48 });
      const context = small.getContext("2d", { willReadFrequently: true });
      const seen = [];
      for (const share of at) {
        const sought = new Promise((resolve) => (video.onseeked = resolve));
        video.currentTime = share * video.duration;
        await sought;
        context.drawImage(video, 0, 0, 64, 48);
        const { data } = context.getImageData(0, 0, 64, 48);
        seen.push(Array.from({ length: 64 * 48 }, (_, i) => data[4 * i + 1]));
      }
      return { duration: video.duration, width: video.videoWidth, height: video.videoHeight, seen };
    },
    [bytes.toString("base64"), shares],
  );
}

/// The mean difference of two pictures, of 255.
const apart = (a, b) => a.reduce((sum, value, i) => sum + Math.abs(value - b[i]), 0) / a.length;

describe("films", () => {
  let torus;
  before(async () => {
    torus = await openTorus();
    await torus.set("seconds", 1);
  });
  afterEach(() => torus.assertFine());
  after(() => torus.close());

  const film = async () => {
    const [download] = await Promise.all([torus.page.waitForEvent("download"), torus.set("Save the film")]);
    assert.equal(download.suggestedFilename(), "torus.webm");
    return readFileSync(await download.path());
  };

  it("turn about the surface, and give the camera back", async () => {
    const camera = await torus.evaluate((c) => c.view.camera);
    const looks = await torus.evaluate((c) => c.look);
    const bytes = await film();
    assert.ok((await torus.evaluate((c) => c.look)) >= looks + pictures - 1, "each picture has a view of its own");
    assert.deepEqual(await torus.evaluate((c) => c.view.camera), camera);
    // The page's policy lets nothing play that it has not made.
    const other = await torus.context.newPage();
    await other.goto("about:blank");
    const { duration, width, height, seen } = await play(other, bytes, [0, 0.3, 0.6, 0.99]);
    await other.close();
    assert.ok(Math.abs(duration - 1) < 0.1, `${duration} s`);
    const size = await torus.evaluate((c) => c.view.size);
    assert.deepEqual([width, height], [size.width - (size.width % 2), size.height - (size.height % 2)]);
    assert.ok(apart(seen[0], seen[1]) > 2 && apart(seen[1], seen[2]) > 2, "it moves");
    assert.ok(apart(seen[0], seen[3]) < apart(seen[0], seen[1]), "it ends about where it began");
  });

  it("pass the views that were added", async () => {
    const from = await torus.evaluate((c) => c.view.camera);
    await torus.set("Add this view");
    await torus.page.keyboard.press("4");
    await torus.settled(); // the camera's flight is over
    await torus.set("Add this view");
    const to = await torus.evaluate((c) => c.view.camera);
    const cameras = torus.evaluate(
      (c) =>
        new Promise((resolve) => {
          const seen = [];
          const look = () => {
            const { eye } = c.view.camera;
            if (String(seen.at(-1)) !== String(eye)) seen.push(eye);
            if (seen.length > 25) resolve(seen);
            else requestAnimationFrame(look);
          };
          look();
        }),
    );
    const [, seen] = await Promise.all([film(), cameras]);
    const far = (a, b) => Math.hypot(...a.map((value, k) => value - b[k]));
    assert.ok(
      seen.some((eye) => far(eye, from.eye) < 1e-6),
      "the first view",
    );
    const between = seen.filter((eye) => far(eye, from.eye) > 0.01 && far(eye, to.eye) > 0.01);
    assert.ok(between.length > 15, `${between.length} between`);
    await torus.set("Remove the views");
  });

  it("can be stopped", async () => {
    const camera = await torus.evaluate((c) => c.view.camera);
    await torus.set("seconds", 60);
    const downloads = [];
    torus.page.on("download", (download) => downloads.push(download));
    await torus.set("Save the film");
    await torus.page.getByText(/Filming: picture/).waitFor();
    await torus.page.keyboard.press("Escape");
    await torus.page.getByText(/Filming: picture/).waitFor({ state: "hidden" });
    assert.deepEqual(await torus.evaluate((c) => c.view.camera), camera);
    assert.equal(downloads.length, 0);
    await torus.set("seconds", 10);
  });
});
