// A benchmark: a first visit over a slow line. When the page, the poster, its script, the first points and the whole first picture are there,
// what came until then, and how much waits in the line while the camera turns.
//   node tests/client/web/slow_line.mjs MESH [BITS_PER_SECOND [ROUND_TRIP_MS]]

import { closeBrowser, WatchedPage } from "./support/browser.mjs";
import { Server } from "./support/server.mjs";
import { SlowLine } from "./support/slow_line.mjs";

const [mesh, rateGiven = "1000000", roundTripGiven = "200"] = process.argv.slice(2);
if (mesh === undefined) {
  console.error("Usage: node slow_line.mjs MESH [BITS_PER_SECOND [ROUND_TRIP_MS]]");
  process.exit(2);
}
const bitsPerSecond = Number(rateGiven);
const roundTrip = Number(roundTripGiven);

/// Before the page's own scripts: notes when there are the poster, the page's larger part, and points; and when the poster has gone.
function noteTimes() {
  window.times = {};
  const look = () => {
    const c = window.curvecast;
    const hasPoster = document.querySelector("img.poster")?.complete === true;
    if (hasPoster) window.times.poster ??= performance.now();
    else if (window.times.poster !== undefined) window.times.posterGone ??= performance.now();
    if (c !== undefined) window.times.script ??= performance.now();
    if ((c?.store?.count ?? 0) > 0) {
      window.times.points ??= performance.now();
      window.times.pointsThen ??= c.store.count;
    }
    requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
}

const server = await Server.start("--open", mesh);
// The session is made, and its points are known.
await (await WatchedPage.open(server.url)).settled();
await closeBrowser();
const line = await SlowLine.start(Number(new URL(server.url).port), bitsPerSecond, roundTrip);
const url = server.url.replace(/:\d+/, `:${line.port}`);
const page = await WatchedPage.open(url, { prepare: (fresh) => fresh.addInitScript(noteTimes) });
const seen = [];
for (let last = -1, still = 0; still < 15;) {
  const { count, time, times } = await page.page.evaluate(() => ({
    count: window.curvecast?.store?.count ?? 0,
    time: performance.now(),
    times: window.times,
  }));
  if (count !== last) seen.push({ time: Math.round(time), count, bytes: line.down.passed });
  still = count === last && count > 0 ? still + 1 : 0;
  last = count;
  seen.times = times;
  await new Promise((resolve) => setTimeout(resolve, 100));
}
const resources = await page.page.evaluate(() =>
  [...performance.getEntriesByType("navigation"), ...performance.getEntriesByType("resource")].map((entry) => ({
    name: entry.name.split("/").at(-1).slice(0, 40),
    start: Math.round(entry.startTime),
    response: Math.round(entry.responseStart),
    end: Math.round(entry.responseEnd),
    bytes: entry.transferSize,
  })),
);
console.table(resources);
console.log(seen.times);
console.table(seen);
line.down.mostWaiting = 0;
for (let i = 0; i < 20; ++i) {
  await page.evaluate((c, angle) => {
    const { camera } = c.view;
    const [x, y, z] = camera.eye.map((value, k) => value - camera.target[k]);
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    const eye = [cos * x + sin * z, y, cos * z - sin * x].map((value, k) => value + camera.target[k]);
    c.view.camera = { ...camera, eye };
  }, 0.1);
  await new Promise((resolve) => setTimeout(resolve, 250));
}
console.log(
  `while it turned, at most ${Math.round(line.down.mostWaiting)} bytes waited: `,
  `${Math.round((8000 * line.down.mostWaiting) / bitsPerSecond)} ms`,
);
await closeBrowser();
line.stop();
await server.stop();
process.exit(0);
