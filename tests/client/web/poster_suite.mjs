// The picture that the server draws for a page that cannot draw yet.

import assert from "node:assert/strict";
import { after, before, describe, it } from "node:test";

import { WatchedPage } from "./support/browser.mjs";
import { countOf, decode, difference } from "./support/pictures.mjs";
import { pictureFile } from "./support/environment.mjs";
import { sharedServer } from "./support/shared_server.mjs";
import { SlowLine } from "./support/slow_line.mjs";

const block = 16; // pixels
const tolerance = 24; // from the background: a JPEG is not exact
const roundTrip = 100; // ms of the line; over a quick one no page asks for a poster

/// The mean colours of the blocks of a picture.
function blocksOf({ width, height, data }) {
  const columns = Math.floor(width / block);
  const rows = Math.floor(height / block);
  const sums = new Float64Array(3 * columns * rows);
  for (let y = 0; y < rows * block; ++y) {
    for (let x = 0; x < columns * block; ++x) {
      const at = 3 * (Math.floor(y / block) * columns + Math.floor(x / block));
      for (let k = 0; k < 3; ++k) sums[at + k] += data[4 * (y * width + x) + k] / block ** 2;
    }
  }
  return sums;
}

/// The mean difference of the blocks of two pictures of one size.
function differenceOf(a, b) {
  const [one, two] = [blocksOf(a), blocksOf(b)];
  assert.equal(one.length, two.length);
  return one.reduce((sum, value, i) => sum + Math.abs(value - two[i]), 0) / one.length;
}

/// In how many pixels the surface is in one of two pictures alone, over those in which it is in the second.
function shareBeside(a, b, empty) {
  const [one, two] = [a, b].map((picture) => difference(picture, empty, tolerance));
  return countOf(one.map((value, i) => value ^ two[i])) / countOf(two);
}

/// Has a page wait for its larger part until `release()`.
async function held(page) {
  let release;
  const released = new Promise((done) => (release = done));
  await page.route("**/assets/open-*.js", async (route) => {
    await released;
    await route.fallback();
  });
  return release;
}

describe("the poster", () => {
  let url; // over a line that is far, but wide
  let narrow; // over one that is narrow, too
  let lines = [];
  before(async () => {
    const server = await sharedServer();
    const port = Number(new URL(server.url).port);
    lines = [await SlowLine.start(port, 100_000_000, roundTrip), await SlowLine.start(port, 1_000_000, 2 * roundTrip)];
    [url, narrow] = lines.map((line) => server.url.replace(/:\d+/, `:${line.port}`));
  });
  after(() => lines.forEach((line) => line.stop()));

  for (const [what, hash, options] of [
    ["of the whole surface", "points=50000", {}],
    ["beside the panel", "points=50000", { viewport: { width: 1000, height: 600 } }],
    ["before a dark background", "points=50000", { colorScheme: "dark" }],
    ["from the camera of the address", "points=50000&colouring=shading&session=ID&camera=0.5,2,4,0.2,0,0,0,1,0,35", {}],
  ]) {
    it(`shows what the points will: ${what}`, async () => {
      let release;
      const { sessions } = await sharedServer();
      const page = await WatchedPage.open(`${url}#${hash.replace("ID", sessions[0])}`, {
        ...options,
        prepare: async (fresh) => (release = await held(fresh)),
      });
      const poster = page.page.locator("img.poster");
      await poster.waitFor();
      assert.match(await poster.getAttribute("alt"), /picture of the surface/);
      const clip = await page.page.locator("canvas").boundingBox();
      const name = what.replaceAll(" ", "_");
      const early = decode(await page.page.screenshot({ path: pictureFile(`poster_${name}.png`), clip }));
      assert.equal(await page.page.evaluate(() => window.curvecast === undefined), true, "the larger part is not there");
      release();
      await page.settled();
      await poster.waitFor({ state: "detached" });
      const points = await page.picture(`poster_${name}_points.png`);
      const [mean, beside] = [differenceOf(early, points), shareBeside(early, points, await page.emptyPicture())];
      assert.ok(mean < 10, `blocks of ${block} pixels differ by ${mean}: there is a little more light and shade in the poster`);
      assert.ok(beside < 0.06, `${beside} of the surface is elsewhere`);
      await page.close();
    });
  }

  it("stays until there are points", async () => {
    const page = await WatchedPage.open(`${url}#points=5000`, {
      prepare: (fresh) =>
        fresh.addInitScript(() => {
          window.gaps = 0; // frames with neither poster nor points, after the poster
          let had = false;
          const look = () => {
            const has = document.querySelector("img.poster") !== null;
            had ||= has;
            if (had && !has && (window.curvecast?.store?.count ?? 0) === 0) ++window.gaps;
            requestAnimationFrame(look);
          };
          requestAnimationFrame(look);
        }),
    });
    await page.settled();
    await page.page.locator("img.poster").waitFor({ state: "detached" });
    assert.equal(await page.page.evaluate(() => window.gaps), 0);
    await page.close();
  });

  for (const status of [204, 503]) {
    it(`is done without where the server has none: ${status}`, async () => {
      const page = await WatchedPage.open(`${url}#points=5000`, {
        prepare: (fresh) => fresh.route("**/v1/poster*", (route) => route.fulfill({ status })),
      });
      if (status === 503) page.expect(/503/);
      await page.settled();
      assert.equal(await page.page.locator("img.poster").count(), 0);
      await page.close();
    });
  }

  it("is not asked for where the server would draw something else", async () => {
    let asked = 0;
    const page = await WatchedPage.open(`${url}#points=5000&colouring=normal`, {
      prepare: (fresh) => fresh.on("request", (request) => (asked += request.url().includes("/v1/poster") ? 1 : 0)),
    });
    await page.settled();
    assert.equal(asked, 0);
    await page.close();
  });

  it("is not asked for over a quick line", async () => {
    let asked = 0;
    const { url: near } = await sharedServer();
    const page = await WatchedPage.open(`${near}#points=5000`, {
      prepare: (fresh) => {
        fresh.on("request", (request) => (asked += request.url().includes("/v1/poster") ? 1 : 0));
        // Also where this machine is busy.
        return fresh.addInitScript(() => {
          const { getEntriesByType } = performance;
          performance.getEntriesByType = (type) =>
            type === "navigation" ? [{ requestStart: 1, responseEnd: 5 }] : getEntriesByType.call(performance, type);
        });
      },
    });
    await page.settled();
    assert.equal(asked, 0);
    await page.close();
  });

  it("comes before the larger part of the page", async () => {
    const page = await WatchedPage.open(`${narrow}#points=5000`);
    await page.page.locator("img.poster").waitFor();
    await page.settled();
    await page.page.locator("img.poster").waitFor({ state: "detached" });
    const entries = await page.page.evaluate(() =>
      performance.getEntriesByType("resource").map(({ name, startTime, responseStart }) => ({ name, startTime, responseStart })),
    );
    const poster = entries.find(({ name }) => name.includes("/v1/poster"));
    const larger = entries.filter(({ name }) => /\/(open|client|overlay_shapes)-/.test(name));
    assert.ok(larger.length > 2);
    for (const { name, startTime } of larger) assert.ok(startTime >= poster.responseStart, `${name} waits for the poster`);
    const starts = larger.map(({ startTime }) => startTime);
    assert.ok(Math.max(...starts) - Math.min(...starts) < roundTrip, "all at once");
    await page.close();
  });
});
