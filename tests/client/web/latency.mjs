// A benchmark: how long the first points and those of further views take, from the page to the buffers of the graphics card.
//   node tests/client/web/latency.mjs MESH [POINTS [TURNS]]
// Where there is no graphics card, drawing is done by the processor, on the cores that everything else runs on.

import { closeBrowser, WatchedPage } from "./support/browser.mjs";
import { Server } from "./support/server.mjs";

const [mesh, pointsGiven = "50000", turnsGiven = "100"] = process.argv.slice(2);
if (mesh === undefined) {
  console.error("Usage: node latency.mjs MESH [POINTS [TURNS]]");
  process.exit(2);
}
const points = Number(pointsGiven);
const navigations = 3;
const turns = Number(turnsGiven); // of 1 degree each
const jumps = Math.ceil(turns / 3); // to another side
const rounds = [
  [640, 480],
  [1280, 720],
];

/// Before the page's own scripts: notes when the first picture with points has been drawn, ms after the navigation began.
function noteFirstPoints() {
  const look = () => {
    const c = window.curvecast;
    if (c !== undefined) window.scriptRan ??= performance.now();
    if (!((c?.store?.count ?? 0) > 0)) return requestAnimationFrame(look);
    window.pointsCame = performance.now();
    requestAnimationFrame(() =>
      requestAnimationFrame(() => {
        const gl = document.querySelector("canvas").getContext("webgl2");
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); // waits until it is drawn
        window.firstPoints = performance.now();
      }),
    );
  };
  requestAnimationFrame(look);
}

/// Looks from each side in turn, and notes what its frames cost; seconds. `first`: the points of the first frame are in the buffers of
/// the graphics card, `whole`: all are; both since the view was asked for.
const measure = async (c, { count, degrees }) => {
  const { view } = c;
  const upload = view.uploadNow;
  const came = [];
  view.uploadNow = function () {
    const milliseconds = upload.call(this);
    came.push({ time: performance.now(), upload: milliseconds / 1000, report: c.statistics.last });
    return milliseconds;
  };
  const frame = () => new Promise(requestAnimationFrame);
  const { eye, target, ...rest } = view.camera;
  const [x, z] = [eye[0] - target[0], eye[2] - target[2]];
  const found = [];
  for (let i = 1; i <= count; ++i) {
    const angle = (i * degrees * Math.PI) / 180;
    const look = c.look;
    came.length = 0;
    const begin = performance.now();
    const at = [
      target[0] + x * Math.cos(angle) - z * Math.sin(angle),
      eye[1],
      target[2] + x * Math.sin(angle) + z * Math.cos(angle),
    ];
    view.camera = { ...rest, target, eye: at };
    const isWhole = () => c.look > look && c.statistics.last.sequence === c.look && c.store.count === c.settings.points;
    while (!isWhole()) await frame();
    const frames = came.filter(({ report }) => report.sequence === c.look);
    const [first] = frames;
    const { report } = first;
    const whole = frames.find(({ report: each }) => each.points === c.settings.points);
    found.push({
      isDelta: report.isDelta,
      frames: frames.length,
      bytes: frames.reduce((sum, each) => sum + each.report.bytes, 0),
      waiting: (first.time - begin) / 1000 - report.viewSeconds - first.upload,
      server: report.serverSeconds,
      decode: report.decodeSeconds,
      store: report.storeSeconds,
      upload: first.upload,
      transport: report.viewSeconds - report.serverSeconds - report.decodeSeconds - report.storeSeconds,
      sent: report.viewSeconds + first.upload,
      first: (first.time - begin) / 1000,
      whole: (whole.time - begin) / 1000,
    });
    await frame();
  }
  view.uploadNow = upload;
  view.camera = { ...rest, eye, target };
  return found;
};

function quantile(values, q) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.max(0, Math.ceil(q * sorted.length) - 1)] ?? NaN;
}

const inMilliseconds = (seconds) => (1000 * seconds).toFixed(1).padStart(7);

function print(name, found) {
  if (found.length === 0) return console.log(`${name}: none`);
  const columns = ["sent", "waiting", "transport", "server", "decode", "store", "upload", "first", "whole"];
  const bytes = quantile(
    found.map((each) => each.bytes),
    0.5,
  );
  console.log(
    `${name}: ${found.length} views, ${(bytes / 1024).toFixed(1)} KiB and ${quantile(
      found.map((each) => each.frames),
      0.5,
    )} frames each`,
  );
  console.log(`        ${columns.map((column) => column.padStart(9)).join("")}`);
  for (const q of [0.5, 0.99]) {
    console.log(
      `  p${100 * q}`.padEnd(8) +
        columns
          .map(
            (column) =>
              "  " +
              inMilliseconds(
                quantile(
                  found.map((each) => each[column]),
                  q,
                ),
              ),
          )
          .join(""),
    );
  }
}

const server = await Server.start("--open", mesh);
console.log(`${mesh.split("/").at(-1)}, ${points} points; milliseconds. sent: from sending the view to points in the graphics card's buffers =
transport + server + decode + store + upload; waiting: before it was sent; first, whole: since the camera moved, with a part and
with all of the points.`);
for (const [width, height] of rounds) {
  console.log(`\n${width} x ${height}`);
  // A new window first loads what the browser shows around pages.
  const prepare = async (page) => (await page.addInitScript(noteFirstPoints), await page.waitForTimeout(1500));
  const options = { viewport: { width, height }, prepare };
  const firsts = [];
  for (let i = 0; i < navigations; ++i) {
    const page = await WatchedPage.open(`${server.url}`, options);
    await page.page.waitForFunction(() => window.firstPoints !== undefined, undefined, { timeout: 60_000 });
    firsts.push(await page.page.evaluate(() => ({ ran: window.scriptRan, came: window.pointsCame, drawn: window.firstPoints })));
    await page.close();
  }
  const text = (part) => firsts.map((each) => each[part].toFixed(0)).join(", ");
  console.log(`first points after navigation: script has run ${text("ran")}; in the store ${text("came")}; drawn ${text("drawn")}`);
  const page = await WatchedPage.open(`${server.url}#points=${points}`, options);
  await page.answered();
  const small = await page.evaluate(measure, { count: turns, degrees: 1 });
  await page.answered();
  const large = await page.evaluate(measure, { count: jumps, degrees: 97 });
  print(
    "deltas, 1 degree each",
    small.filter(({ isDelta }) => isDelta),
  );
  print(
    "key frames, another side each",
    large.filter(({ isDelta }) => !isDelta),
  );
  const pictures = await page.evaluate(async (c) => {
    const times = [];
    for (let i = 0; i < 8; ++i) {
      const begin = performance.now();
      await c.view.screenshot();
      times.push((performance.now() - begin) / 1000);
    }
    return times;
  });
  console.log(`a picture with all its pixels, as PNG: ${inMilliseconds(quantile(pictures, 0.5)).trim()}`);
  await page.close();
}
await closeBrowser();
await server.stop();
