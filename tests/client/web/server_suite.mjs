// What the page does when meshes, servers and browsers are not as it would like them.

import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { describe, it } from "node:test";

import { WatchedPage } from "./support/browser.mjs";
import { sharedMesh } from "./support/environment.mjs";
import { bumpyTorus } from "./support/meshes.mjs";
import { Server, temporaryFolder } from "./support/server.mjs";
import { sharedServer } from "./support/shared_server.mjs";

const points = 3000;
const moreThanPoll = 6; // seconds; the page asks for the list of sessions every 5
const prepare = (page) => page.clock.install();
const lostConnection = /WebSocket connection|ERR_CONNECTION_REFUSED|net::ERR/; // said by Chromium itself

/// A server without meshes.
async function withServer(options, run) {
  const server = await Server.start("--max-curve-vertices", "0", ...options);
  try {
    await run(server);
  } finally {
    await server.stop();
  }
}

function torusFile() {
  const path = join(temporaryFolder(), "ring.off");
  writeFileSync(path, bumpyTorus(60, 24));
  return path;
}

async function choose(page, ...files) {
  const [chooser] = await Promise.all([page.page.waitForEvent("filechooser"), page.page.keyboard.press("u")]);
  await chooser.setFiles(files);
}

describe("uploads", () => {
  it("show a great mesh coarsely at first, and go on with the real one in the same picture", () =>
    withServer([], async ({ url }) => {
      const columns = 1024,
        rows = 500;
      const path = join(temporaryFolder(), "great.off");
      writeFileSync(path, bumpyTorus(columns, rows));
      const page = await WatchedPage.open(`${url}#points=${points}`);
      await page.page.getByText("Drop a mesh here").waitFor();
      await page.page.evaluate(() => {
        window.notices = "";
        new MutationObserver((changes) => {
          for (const { addedNodes } of changes) addedNodes.forEach((node) => (window.notices += node.textContent));
        }).observe(document.body, { subtree: true, childList: true });
      });
      await choose(page, path);
      await page.until((c, faces) => Number(c.session?.report.mesh.faces) === faces, 2 * columns * rows);
      await page.settled();
      assert.match(await page.page.evaluate(() => window.notices), /A coarse preview/);
      assert.equal(await page.evaluate((c) => c.store.count), points);
      await page.close();
    }));

  it("begin with an invitation, show their progress, and end with the surface", () =>
    withServer([], async ({ url }) => {
      const page = await WatchedPage.open(`${url}#points=${points}`, { prepare });
      await page.page.getByText("Drop a mesh here").waitFor();
      await page.screenshot("invitation.png");
      const offer = await page.page.$(".card button");
      await page.listedAgain();
      assert.ok(await offer.evaluate((element) => element.isConnected), "it stays what it is while the list is asked for again");
      await page.page.evaluate(() => {
        window.seen = [];
        new MutationObserver(() =>
          document.querySelectorAll(".upload progress").forEach((bar) => window.seen.push(bar.value)),
        ).observe(document.body, { subtree: true, childList: true, attributes: true, characterData: true });
      });
      await choose(page, sharedMesh("spot.obj") ?? torusFile());
      await page.settled();
      assert.equal(await page.evaluate((c) => c.store.count), points);
      const seen = await page.page.evaluate(() => window.seen);
      assert.ok(seen.length > 0 && seen.every((value, i) => i === 0 || value >= seen[i - 1] - 1e-3), `progress grows: ${seen}`);
      assert.equal(await page.page.getByText("Drop a mesh here").isVisible(), false);
      await page.screenshot("uploaded.png");

      // One that is broken: the page says why, and goes on with what it shows.
      const session = await page.evaluate((c) => c.session.sessionId);
      await choose(page, {
        name: "broken.ply",
        mimeType: "application/octet-stream",
        buffer: Buffer.from("ply\nformat ascii 1.0\nelement vertex 3\n"),
      });
      const failure = page.page.locator(".failure");
      await failure.waitFor();
      assert.match(await failure.innerText(), /broken\.ply could not be opened[\s\S]*\w{3}/);
      await page.screenshot("broken_upload.png");
      await failure.getByRole("button").click();
      await choose(page, { name: "empty.ply", mimeType: "application/octet-stream", buffer: Buffer.alloc(0) });
      await failure.getByText("the file empty.ply is empty").waitFor();
      await failure.getByRole("button").click();
      await choose(page, { name: "leaves.mtl", mimeType: "text/plain", buffer: Buffer.from("newmtl leaves\n") });
      await page.page.getByText("none of these files is a mesh").waitFor();
      assert.equal(await page.evaluate((c) => c.session.sessionId), session);
      await page.change(() =>
        page.drag([
          [320, 240],
          [380, 260],
        ]),
      );
      assert.equal(await page.evaluate((c) => c.store.count), points);

      // Dropped anywhere; then the list has two.
      const data = await page.page.evaluateHandle((text) => {
        const transfer = new DataTransfer();
        transfer.items.add(new File([text], "ring.off"));
        return transfer;
      }, bumpyTorus(48, 20).toString()); // another one than might have been chosen before
      await page.page.keyboard.press("z");
      for (const type of ["dragenter", "dragover", "drop"]) await page.page.dispatchEvent("canvas", type, { dataTransfer: data });
      await page.until((c, old) => c.session.sessionId !== old, session);
      await page.settled();
      assert.equal(await page.evaluate((c) => c.settings.frozen), false);
      assert.equal(await page.evaluate((c) => c.look), 1, "it was never asked for what the camera of before sees");
      await page.page.waitForFunction(() => document.querySelectorAll(".session").length === 2);
      assert.equal(await page.page.locator(".dropping").count(), 0);
      assert.match(await page.page.title(), /ring\.off/);
      await page.close();
    }));
});

describe("a lost server", () => {
  it("is told, and found again by itself when it is back", async () => {
    const server = await Server.start("--max-curve-vertices", "0", "--cache", temporaryFolder(), "--open", torusFile());
    const page = await WatchedPage.open(`${server.url}#points=${points}`);
    page.expect(lostConnection);
    await page.settled();
    const frames = await page.evaluate((c) => c.statistics.frames);
    await server.logged(/ cached in /); // what is there survives the kill
    await server.kill();
    await page.until((c) => c.state === "reconnecting");
    await page.page.getByRole("alert").getByText("Trying again").waitFor();
    await page.screenshot("lost.png");
    assert.equal(await page.evaluate((c) => c.store.count), points, "the points stay");
    await server.restart();
    await page.until((c) => c.state === "streaming" || c.state === "refining");
    await page.page.getByRole("alert").waitFor({ state: "hidden" });
    await page.change(() =>
      page.drag([
        [320, 240],
        [380, 260],
      ]),
    );
    const now = await page.evaluate((c) => ({ count: c.store.count, frames: c.statistics.frames, last: c.statistics.last }));
    assert.equal(now.count, points);
    assert.ok(now.frames > frames);
    assert.ok(now.last.isDelta, "the stream goes on with deltas");
    await page.close();
    await server.stop();
  });
});

describe("a server without a cache that is restarted", () => {
  it("gets the mesh again from the page", () =>
    withServer([], async (server) => {
      const page = await WatchedPage.open(`${server.url}#points=${points}`);
      page.expect(lostConnection);
      await page.page.getByText("Drop a mesh here").waitFor();
      await choose(page, torusFile());
      await page.settled();
      await server.kill();
      await server.restart();
      await page.page.getByText("This session is not there").waitFor();
      await page.screenshot("missing.png");
      await page.page.getByRole("button", { name: "Open ring.off again" }).click();
      await page.page.getByText("This session is not there").waitFor({ state: "hidden" });
      await page.settled();
      assert.equal(await page.evaluate((c) => c.store.count), points);
      await page.close();
    }));
});

describe("a token", () => {
  it("is asked for, and kept for the tab", async () => {
    const tokens = join(temporaryFolder(), "tokens");
    writeFileSync(tokens, `someone ${createHash("sha256").update("open sesame").digest("hex")}\n`);
    await withServer(["--tokens", tokens], async ({ url }) => {
      const page = await WatchedPage.open(url, { prepare });
      page.expect(lostConnection);
      const input = page.page.getByLabel("Token");
      await input.waitFor();
      await page.screenshot("token.png");
      await input.fill("half a");
      const { lists } = page;
      await page.pass(moreThanPoll);
      assert.equal(page.lists, lists, "nothing is asked before there is another token");
      assert.equal(await input.inputValue(), "half a", "what was typed stays");
      await input.fill("wrong");
      await Promise.all([page.page.waitForEvent("load"), page.page.keyboard.press("Enter")]);
      await input.waitFor();
      await input.fill("open sesame");
      await Promise.all([page.page.waitForEvent("load"), page.page.getByRole("button", { name: "Continue" }).click()]);
      await page.page.getByText("Drop a mesh here").waitFor();
      await page.page.reload();
      await page.page.getByText("Drop a mesh here").waitFor();
      await page.close();
      const direct = await WatchedPage.open(`${url}#token=open%20sesame`);
      await direct.page.getByText("Drop a mesh here").waitFor();
      assert.ok(!direct.page.url().includes("sesame"), "the address does not keep it");
      await direct.close();
    });
  });
});

describe("an address of a session that is not there", () => {
  it("is told of, and nothing else is shown before the user chooses it", async () => {
    const { url } = await sharedServer();
    const page = await WatchedPage.open(`${url}#session=0123456789abcdef0123456789abcdef&points=${points}`, {
      prepare,
      viewport: { width: 1000, height: 480 }, // with the panel
    });
    const card = page.page.getByText("This session is not there");
    await card.waitFor();
    const row = page.page.locator(".session button").first();
    await row.focus();
    await page.listedAgain();
    assert.ok(await card.isVisible());
    assert.equal(await page.evaluate((c) => c.state), "none");
    assert.match(page.page.url(), /session=0123456789abcdef/, "the address stays");
    assert.ok(await row.evaluate((element) => element === document.activeElement), "rows of the list keep the focus");
    await row.click();
    await page.settled();
    assert.equal(await card.isVisible(), false);
    await page.close();
  });
});

describe("a page in another scene", () => {
  it("says where there is no session", () =>
    withServer([], async ({ url }) => {
      const page = await WatchedPage.open(`${url}example.html`);
      await page.page.getByText("no session that is ready").waitFor();
      await page.close();
    }));
});

describe("a page of which a part does not load", () => {
  it("says so", () =>
    withServer([], async ({ url }) => {
      const page = await WatchedPage.open(url, {
        prepare: (opened) => opened.route(/\/open-[^/]*\.js$/, (route) => route.abort()),
      });
      page.expect(/net::ERR|Failed to load/); // said by Chromium itself
      await page.page.getByText("could not be loaded").waitFor();
      await page.close();
    }));
});

describe("a browser that keeps nothing for pages", () => {
  it("shows the page all the same", () =>
    withServer([], async ({ url }) => {
      const page = await WatchedPage.open(url, {
        prepare: (opened) =>
          opened.addInitScript(() => {
            Object.defineProperty(window, "sessionStorage", {
              get: () => {
                throw new DOMException("blocked", "SecurityError");
              },
            });
          }),
      });
      await page.page.getByText("Drop a mesh here").waitFor();
      await page.close();
    }));
});

describe("a browser without WebGL 2", () => {
  it("says so", () =>
    withServer([], async ({ url }) => {
      const page = await WatchedPage.open(url, {
        prepare: (opened) =>
          opened.addInitScript(() => {
            const getContext = HTMLCanvasElement.prototype.getContext;
            HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
              return kind === "webgl2" ? null : getContext.call(this, kind, ...rest);
            };
          }),
      });
      await page.page.getByText("WebGL 2").first().waitFor();
      await page.screenshot("no_webgl2.png");
      await page.close();
    }));
});
