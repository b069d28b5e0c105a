// Point clouds of the user's own files in a real browser: dropped on the page of a real server, which is never told of them.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, before, describe, it } from "node:test";

import { faultsOf } from "./support/access.mjs";
import { WatchedPage } from "./support/browser.mjs";
import { lasCloud, plyCloud, spherePoints, xyzCloud } from "./support/clouds.mjs";
import { boxOf, countOf, difference, filled } from "./support/pictures.mjs";
import { Server } from "./support/server.mjs";
import { endAll, openTorus } from "./support/shared_server.mjs";

const count = 20_000;
const small = 2000;

/// Drops files on the page: [name, bytes] each.
async function drop(watched, ...files) {
  const transfer = await watched.page.evaluateHandle(
    (given) => {
      const made = new DataTransfer();
      for (const [name, text] of given) {
        made.items.add(new File([Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0))], name));
      }
      return made;
    },
    files.map(([name, bytes]) => [name, bytes.toString("base64")]),
  );
  for (const type of ["dragenter", "dragover", "drop"])
    await watched.page.dispatchEvent("canvas", type, { dataTransfer: transfer });
}

/// Waits until the page shows a cloud of so many points.
const shown = (watched, points) => watched.until((c, wanted) => c.session === null && c.store?.count === wanted, points);

/// Asserts that the picture shows a round disc, whole, without holes. Returns its box.
async function assertRound(watched, name) {
  const picture = await watched.picture(name);
  const { width, height } = picture;
  const mask = filled(difference(picture, await watched.emptyPicture(), 12), width);
  const box = boxOf(mask, width);
  const [across, down] = [box.right - box.left + 1, box.bottom - box.top + 1];
  assert.ok(down > 0.5 * height && down < height && across < width, `${across} x ${down} pixels of ${width} x ${height}`);
  assert.ok(Math.abs(across / down - 1) < 0.03, `${across} x ${down} pixels`);
  const area = (Math.PI / 4) * across * down;
  assert.ok(Math.abs(countOf(mask) / area - 1) < 0.02, `${countOf(mask)} pixels, and ${area.toFixed()} of a disc`);
  const [x, y, r] = [(box.left + box.right) / 2, (box.top + box.bottom) / 2, 0.96 * (across / 2)];
  const holes = mask.filter((value, i) => !value && Math.hypot((i % width) - x, Math.floor(i / width) - y) < r);
  assert.equal(holes.length, 0, "holes");
  return { picture, box };
}

/// The mean colour of the pixels within `reach` of a place, which is a share of the picture.
function meanAt({ width, height, data }, x, y, reach = 6) {
  const sums = [0, 0, 0];
  const [left, top] = [Math.round(x * width) - reach, Math.round(y * height) - reach];
  for (let i = 0; i < (2 * reach + 1) ** 2; ++i) {
    const at = 4 * ((top + Math.floor(i / (2 * reach + 1))) * width + left + (i % (2 * reach + 1)));
    for (let k = 0; k < 3; ++k) sums[k] += data[at + k] / (2 * reach + 1) ** 2;
  }
  return sums;
}

after(endAll);

const redAndBlue = ([, , z]) => (z > 0 ? [220, 30, 30] : [30, 30, 220]);

describe("a point cloud of the user's own", () => {
  let torus;
  let session;
  before(async () => {
    torus = await openTorus("points=5000", { viewport: { width: 940, height: 480 } }); // room for the panel
    session = await torus.evaluate((c) => c.session.sessionId);
    await torus.page.evaluate(() => {
      window.notices = "";
      new MutationObserver((changes) => {
        for (const { addedNodes } of changes) addedNodes.forEach((node) => (window.notices += node.textContent));
      }).observe(document.body, { subtree: true, childList: true });
    });
  });
  after(() => torus.close());

  it("is shown in its colours, from both sides", async () => {
    let sent = 0;
    torus.page.on("websocket", (socket) => socket.on("framesent", () => ++sent));
    await drop(torus, ["ball.ply", plyCloud(spherePoints(count), redAndBlue)]);
    await shown(torus, count);
    await torus.screenshot("cloud_page.png");
    assert.equal(sent, 0, "no connection is opened for it");
    assert.match(await torus.page.title(), /^ball\.ply/);
    assert.match(await torus.page.evaluate(() => window.notices), /ball\.ply is shown from its file: nothing was sent/);
    assert.match(await torus.page.locator(".hud").innerText(), /point cloud from a file[\s\S]*20,000/);
    await torus.evaluate((c) => (c.view.camera = { eye: [0, 0, 6], target: [0, 0, 0], up: [0, 1, 0], fov: 30 }));
    const front = await assertRound(torus, "cloud_front.png");
    const [red, , blue] = meanAt(front.picture, 0.5, 0.5);
    assert.ok(red > 2 * blue, `red in front: ${red} and ${blue}`);
    await torus.evaluate((c) => (c.view.camera = { eye: [0, 0, -6], target: [0, 0, 0], up: [0, 1, 0], fov: 30 }));
    const back = await assertRound(torus, "cloud_back.png");
    const [redBehind, , blueBehind] = meanAt(back.picture, 0.5, 0.5);
    assert.ok(blueBehind > 2 * redBehind, `blue behind: ${redBehind} and ${blueBehind}`);
    assert.deepEqual(await faultsOf(torus), []);
  });

  it("has an inside that is as bright as its outside", async () => {
    await torus.evaluate((c) => (c.view.camera = { eye: [0, 0, 6], target: [0, 0, 0], up: [0, 1, 0], fov: 30 }));
    const outside = meanAt(await torus.picture(), 0.5, 0.5);
    await torus.set("cut across", "Z"); // the half towards the eye goes
    const inside = meanAt(await torus.picture("cloud_inside.png"), 0.5, 0.5);
    assert.ok(inside[2] > 0.75 * outside[0], `blue of ${inside}, red of ${outside}`);
    await torus.set("cut across", "no");
  });

  it("can be measured, drawn as dots, and saved, and has no parts of the panel that are of sessions", async () => {
    const pick = await torus.evaluate((c) => c.view.pick(c.view.cssSize.width / 2, c.view.cssSize.height / 2));
    assert.ok(Math.abs(pick.point[2] - 1) < 0.01 && pick.normal[2] > 0.99, JSON.stringify(pick));
    await torus.page.keyboard.press("m");
    await torus.page.mouse.click(320, 240);
    await torus.page.mouse.click(400, 240);
    await torus.page.locator(".hud dd.distance").waitFor();
    await torus.page.keyboard.press("m");
    const discs = await torus.picture();
    await torus.page.keyboard.press("2");
    assert.ok(countOf(difference(discs, await torus.picture("cloud_dots.png"))) > 1000, "dots are not discs");
    await torus.page.keyboard.press("1");
    const [download] = await Promise.all([torus.page.waitForEvent("download"), torus.page.keyboard.press("x")]);
    assert.equal(download.suggestedFilename(), `ball-${count}.ply`);
    assert.match(readFileSync(await download.path(), "latin1").slice(0, 400), /element vertex 20000[\s\S]*property uchar red/);
    for (const key of ["b", "v", "z", "t"]) await torus.page.keyboard.press(key);
    const { brush, split, frozen, wireframe } = await torus.evaluate((c) => c.settings);
    assert.deepEqual([brush, split, frozen, wireframe], [false, false, false, false], "what only sessions have stays off");
    for (const title of ["Number of points", "Paint the density", "Mesh of the points"])
      assert.equal(await torus.page.getByText(title, { exact: true }).isVisible(), false, title);
    await torus.page.keyboard.press("y");
    await torus.page.getByText("A link cannot hold points").waitFor();
  });

  it("gives way to a session that is chosen", async () => {
    await torus.page.locator(".session button").first().click();
    await torus.until((c, id) => c.session?.sessionId === id, session);
    await torus.settled();
    assert.equal(await torus.evaluate((c) => c.store.count), 5000);
    assert.match(await torus.page.title(), /^torus\.off/);
    assert.match(await torus.page.locator(".hud").innerText(), /live[\s\S]*traffic/);
    assert.ok(await torus.page.getByText("Number of points", { exact: true }).isVisible());
    await torus.change(() =>
      torus.drag([
        [320, 240],
        [380, 260],
      ]),
    );
    await torus.page.waitForFunction((id) => location.hash.includes(id), session);
  });

  it("may be plain lines of text, far from the origin", async () => {
    const centre = [4_512_345.6, -1200.5, 98_765.4];
    await drop(torus, ["scan.xyz", xyzCloud(spherePoints(small, centre, 0.5))]);
    await shown(torus, small);
    await assertRound(torus, "cloud_text.png");
    const { min, max } = await torus.evaluate((c) => c.view.bounds);
    min.forEach((least, axis) => assert.ok(Math.abs((least + max[axis]) / 2 - centre[axis]) < 1e-3));
    const pick = await torus.evaluate((c) => c.view.pick(320, 240));
    const away = Math.hypot(...pick.point.map((value, axis) => value - centre[axis]));
    assert.ok(Math.abs(away - 0.5) < 5e-3, `${away} from the centre`);
  });

  it("may be LAS, with Z up", async () => {
    const centre = [500_000, 5_400_000, 300];
    const points = spherePoints(small, centre, 20);
    await drop(torus, ["flight.las", lasCloud(points, centre, ([, , z]) => (z > centre[2] ? [220, 30, 30] : [30, 30, 220]))]);
    await torus.page.waitForFunction(() => document.title.startsWith("flight.las"));
    const { picture } = await assertRound(torus, "cloud_las.png");
    const [above, below] = [meanAt(picture, 0.5, 0.3), meanAt(picture, 0.5, 0.7)];
    assert.ok(above[0] > 2 * above[2] && below[2] > 2 * below[0], `red above, blue below: ${above}; ${below}`);
    assert.equal(await torus.evaluate((c) => c.settings.up), "z");
  });

  it("says what is wrong with it, and leaves the page as it is", async () => {
    const failure = torus.page.locator(".failure");
    for (const [name, bytes, message] of [
      ["junk.xyz", Buffer.from("this is\nno cloud\nat all\n"), /junk\.xyz could not be opened[\s\S]*line 2, "no cloud"/],
      ["short.las", Buffer.from("LASF"), /4 bytes, and a LAS header has 227/],
      ["empty.txt", Buffer.alloc(0), /the file is empty/],
    ]) {
      await drop(torus, [name, bytes]);
      await failure.waitFor();
      assert.match(await failure.innerText(), message);
      await failure.getByRole("button").click();
    }
    const cut = plyCloud(spherePoints(small), redAndBlue);
    await drop(torus, ["cut.ply", cut.subarray(0, cut.length - 150)]);
    await shown(torus, small - 10);
    assert.match(await torus.page.evaluate(() => window.notices), /The file ends after 1,990 of 2,000 points/);
  });
});

describe("a point cloud where there is no session", () => {
  it("is shown instead of the invitation, and by the button, too", async () => {
    const server = await Server.start();
    const page = await WatchedPage.open(server.url);
    await page.page.getByText("Drop a mesh here").waitFor();
    const chooser = page.page.waitForEvent("filechooser");
    await page.page.getByRole("button", { name: "Choose files …" }).click();
    await (await chooser).setFiles({ name: "ball.pts", mimeType: "text/plain", buffer: xyzCloud(spherePoints(small)) });
    await shown(page, small);
    await assertRound(page, "cloud_alone.png");
    assert.equal(await page.page.getByText("Drop a mesh here").isVisible(), false);
    await page.page.waitForFunction(() => document.querySelector(".sessions")?.textContent === "none yet");
    await page.close();
    await server.stop();
  });
});
