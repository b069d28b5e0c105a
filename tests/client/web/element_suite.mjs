// The element <curvecast-view> of the npm package, in pages of another origin than the server.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { before, describe, it } from "node:test";

import { faultsOf } from "./support/access.mjs";
import { WatchedPage } from "./support/browser.mjs";
import { writeExample } from "./support/npm_package.mjs";
import { drawn, openFile, packageSite } from "./support/package_site.mjs";
import { decode } from "./support/pictures.mjs";
import { StaticSite } from "./support/static_site.mjs";

const lostConnection = /WebSocket connection to .* failed/; // the browser's own words
const element = "curvecast-view";

let folder, strictSite, server, target;
before(async () => ({ folder, strictSite, server, target } = await packageSite()));

/// Makes a page whose body is as given, with the element's module; the server is what `src` begins with.
function page(name, body, head = "") {
  const script = '<script type="module" src="./element.js"></script>';
  writeFileSync(
    join(folder, name),
    `<!doctype html><html lang="en"><head><meta charset="utf-8" /><title>A page</title>${script}${head}</head><body>${body}</body></html>`,
  );
  return openFile(name);
}

const tag = (attributes = "", points = 3000) =>
  `<${element} src="${server.url}" token="${target.token}" points="${points}" ${attributes}></${element}>`;

/// Until the elements of a page show their sessions; `count` of them.
const ready = (watched, count = 1) =>
  watched.page.waitForFunction(
    ([name, wanted]) => {
      const all = [...document.querySelectorAll(name)];
      return all.length === wanted && all.every((view) => view.shown?.isReady === true);
    },
    [element, count],
    { timeout: 120_000 },
  );

/// Notes what elements tell from the first on: window.told has [type, detail of errors or points of frames].
const noteEvents = async (inPage) =>
  inPage.addInitScript(() => {
    window.told = [];
    for (const type of ["ready", "frame", "error"])
      document.addEventListener(
        type,
        ({ detail }) => detail && window.told.push([type, detail.code ?? detail.points ?? detail.sessionId]),
        {
          capture: true,
        },
      );
  });

/// What axe finds wrong with the element; that a page has no heading is the page's affair.
const elementFaults = async (watched) =>
  (await faultsOf(watched)).filter((fault) => !/^(landmark-one-main|page-has-heading-one):/.test(fault));

const words = (watched, nth = 0) => watched.page.locator(`${element} p`).nth(nth);
const cameraOf = (watched) => watched.page.evaluate((name) => document.querySelector(name).camera, element);

describe("the element", () => {
  it("shows a session in a page of ten lines, of another origin", async () => {
    writeExample(folder, "plain.html", target);
    assert.ok(readFileSync(join(folder, "plain.html"), "utf8").trimEnd().split("\n").length <= 11);
    const watched = await openFile("plain.html", { prepare: noteEvents });
    await ready(watched);
    await drawn(watched, element, "element.png");
    const told = await watched.page.evaluate(() => window.told);
    assert.deepEqual(
      told.find(([type]) => type === "ready"),
      ["ready", target.session],
    );
    assert.ok(told.some(([type, points]) => type === "frame" && points > 0));
    assert.ok(!told.some(([type]) => type === "error"), JSON.stringify(told));
    assert.ok(await words(watched).isHidden());
    assert.deepEqual(await elementFaults(watched), []);
    const { height, width } = await watched.page.locator(element).boundingBox();
    assert.deepEqual([Math.round(height), Math.round(width)], [480, 624], "as the page's CSS has it");
    await watched.close();
  });

  it("turns by keys only with the focus, and lets the page scroll past it", async () => {
    const watched = await page("keys.html", `<a href="#">before</a>${tag()}<div style="height: 3000px"></div>`);
    await ready(watched);
    const camera = await cameraOf(watched);
    await watched.page.keyboard.press("ArrowLeft");
    await watched.page.mouse.move(300, 200);
    await watched.page.mouse.wheel(0, 60);
    await watched.page.waitForFunction(() => scrollY > 0);
    assert.deepEqual(await cameraOf(watched), camera);
    await watched.page.evaluate(() => scrollTo(0, 0));
    await watched.page.keyboard.press("Tab");
    await watched.page.keyboard.press("Tab");
    assert.equal(await watched.page.evaluate(() => document.activeElement.localName), element);
    await watched.page.keyboard.press("ArrowLeft");
    const turned = await cameraOf(watched);
    assert.notDeepEqual(turned, camera);
    await watched.page.mouse.wheel(0, 60);
    await watched.page.waitForFunction(
      ([name, before]) => document.querySelector(name).camera.eye[0] !== before,
      [element, turned.eye[0]],
    );
    assert.equal(await watched.page.evaluate(() => scrollY), 0);
    await watched.drag([
      [300, 200],
      [340, 220],
    ]);
    await watched.page.evaluate((name) => document.querySelector(name).fit(), element);
    const { size } = await watched.page.evaluate(
      async (name) =>
        document
          .querySelector(name)
          .screenshot(2)
          .then(({ size }) => ({ size })),
      element,
    );
    assert.ok(size > 10_000);
    await watched.close();
  });

  it("follows its attributes", async () => {
    const watched = await page("attributes.html", tag());
    await ready(watched);
    const first = await watched.page.evaluate((name) => document.querySelector(name).session.sessionId, element);
    assert.equal(first, target.session, "the first that is ready");
    const frame = (attribute, value) =>
      watched.page.evaluate(
        ([name, set, to]) =>
          new Promise((done) => {
            const view = document.querySelector(name);
            view.addEventListener("frame", function take({ detail }) {
              if (to !== String(detail.points)) return;
              view.removeEventListener("frame", take);
              done(detail.points);
            });
            view.setAttribute(set, to);
          }),
        [element, attribute, value],
      );
    const camera = await cameraOf(watched);
    assert.equal(await frame("points", "2000"), 2000);
    assert.deepEqual(await cameraOf(watched), camera, "it looks from the same place");
    const [light] = decode(await watched.page.locator(element).screenshot()).data;
    await watched.page.evaluate((name) => document.querySelector(name).setAttribute("background", "dark"), element);
    while (decode(await watched.page.locator(element).screenshot()).data[0] > light - 100) watched.assertFine();
    await watched.page.evaluate((name) => document.querySelector(name).setAttribute("mode", "mesh"), element);
    await watched.page.waitForFunction((name) => document.querySelector(name).shown.surface.shown !== null, element);
    await drawn(watched, element, "element_mesh.png");
    await watched.page.evaluate((name) => document.querySelector(name).setAttribute("src", "mailto:me"), element);
    await words(watched).waitFor({ state: "visible" });
    assert.match(await words(watched).innerText(), /Src is no address of a server/);
    await watched.close();
  });

  it("takes what the viewer copies as a link", async () => {
    const camera = "2,2,2,0,0,0,0,0,1,40";
    const hash = `#session=${target.session}&token=${encodeURIComponent(target.token)}&camera=${camera}&points=1500&colouring=normal&up=z`;
    const watched = await page("link.html", `<${element} src="${server.url}${hash.replaceAll("&", "&amp;")}"></${element}>`);
    await ready(watched);
    const { eye, up, fov } = await cameraOf(watched);
    assert.deepEqual([eye, up, fov], [[2, 2, 2], [0, 0, 1], 40]);
    await drawn(watched, element, "element_link.png");
    await watched.close();
  });

  it("says in words that a token is wrong, that a session or the server is not there", async () => {
    const watched = await page(
      "wrong.html",
      `<${element} src="${server.url}" token="wrong"></${element}><${element} src="${server.url}#session=nothing" token="${target.token}"></${element}>`,
    );
    await words(watched, 0).waitFor({ state: "visible" });
    await words(watched, 1).waitFor({ state: "visible" });
    assert.match(await words(watched, 0).innerText(), /does not let this page see the session: .*token/);
    assert.match(await words(watched, 1).innerText(), /does not have the session nothing/);
    assert.deepEqual(await elementFaults(watched), []);
    const other = await StaticSite.start(folder); // whose pages the server does not take
    const refused = await WatchedPage.open(`${other.origin}/plain.html`, { prepare: noteEvents });
    refused.expect(lostConnection);
    await words(refused).waitFor({ state: "visible" });
    assert.match(await words(refused).innerText(), /cannot be reached. Trying again/);
    await refused.page.waitForFunction(() => window.told.some(([type, code]) => type === "error" && code === "UNAVAILABLE"));
    await refused.close();
    await other.stop();
    await watched.close();
  });

  it("goes on when the server is back", async () => {
    const watched = await page("back.html", tag());
    await ready(watched);
    watched.expect(lostConnection);
    await server.kill();
    await words(watched).waitFor({ state: "visible" });
    assert.match(await words(watched).innerText(), /Trying again/);
    await words(watched).getByRole("button", { name: "Try now" }).click();
    assert.match(await words(watched).innerText(), /Trying again/, "the server is still away");
    await server.restart();
    await words(watched).waitFor({ state: "hidden" });
    await watched.close();
  });

  it("ends its connection when it is removed, and begins anew when it is put back", async () => {
    const sockets = [];
    const workers = [];
    const note = async (inPage) =>
      inPage.on("websocket", (socket) => sockets.push(socket)) && inPage.on("worker", (one) => workers.push(one));
    await (await page("removed.html", tag())).close(); // writes the file
    const watched = await openFile("removed.html", { prepare: note });
    await ready(watched);
    assert.ok(sockets.length > 0 && workers.length > 0);
    const closed = sockets.map((socket) => socket.isClosed() || socket.waitForEvent("close"));
    const ended = workers.map((worker) => new Promise((done) => worker.on("close", done)));
    await watched.page.evaluate((name) => {
      window.removed = document.querySelector(name);
      window.removed.remove();
    }, element);
    await Promise.all([...closed, ...ended]);
    assert.equal(await watched.page.evaluate(() => window.removed.session), null);
    await watched.page.evaluate(() => document.body.append(window.removed));
    await ready(watched);
    await drawn(watched, element, "element_again.png");
    watched.expect(/WebSocket is closed before the connection is established/); // the browser's own words
    for (let i = 0; i < 20; ++i) {
      // Browsers have some 16 contexts for a page: those of removed elements are given back.
      await watched.page.evaluate(() => {
        window.removed.remove();
        document.body.append(window.removed);
      });
    }
    await ready(watched);
    await drawn(watched, element, "element_again.png");
    await watched.close();
  });

  it("is there twice in a page", async () => {
    const watched = await page("two.html", tag('id="a" style="height: 200px"') + tag('id="b" style="height: 200px"', 1000));
    await ready(watched, 2);
    await drawn(watched, "#a", "element_a.png");
    await drawn(watched, "#b", "element_b.png");
    const counts = await watched.page.evaluate(
      (name) => [...document.querySelectorAll(name)].map((view) => view.shown.streams.main.store.count),
      element,
    );
    assert.deepEqual(counts, [3000, 1000]);
    await watched.page.evaluate(() => document.querySelector("#a").remove());
    await watched.page.locator("#b").click();
    const [eye] = [await watched.page.evaluate(() => document.querySelector("#b").camera.eye)];
    await watched.page.keyboard.press("ArrowUp");
    assert.notDeepEqual(await watched.page.evaluate(() => document.querySelector("#b").camera.eye), eye);
    await drawn(watched, "#b", "element_b.png");
    await watched.close();
  });

  it("keeps within the policy that its README names", async () => {
    await (await page("policy.html", tag('mode="mesh"'))).close();
    const watched = await WatchedPage.open(`${strictSite.origin}/policy.html`);
    await ready(watched);
    await watched.page.waitForFunction((name) => document.querySelector(name).shown.surface.shown !== null, element);
    await drawn(watched, element, "element_policy.png");
    await watched.close();
  });
});
