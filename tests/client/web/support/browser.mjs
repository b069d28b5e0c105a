// Chromium, and pages that may do nothing wrong.

import assert from "node:assert/strict";

import { browserPath, chromium, pictureFile } from "./environment.mjs";
import { builtViewerFlags, serveBuiltViewer } from "./built_viewer.mjs";
import { decode } from "./pictures.mjs";

// WebGL without a graphics card, and no talk with the rest of the world.
const flags = [
  "--use-gl=angle",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--js-flags=--expose-gc",
  ...builtViewerFlags,
];

let launched = null;

/// The browser of this process, with a profile that is new.
export async function browser() {
  launched ??= chromium.launch({ executablePath: browserPath, args: flags, chromiumSandbox: false });
  return launched;
}

export async function closeBrowser() {
  await (await launched)?.close();
  launched = null;
}

/// A page, and what it did wrong.
export class WatchedPage {
  #faults = [];
  #expected = [];
  #lists = 0; // requests for the list of sessions

  /// `options` are those of a browser context. `prepare(page)`: before it loads anything.
  static async open(url, { prepare = async () => {}, ...options } = {}) {
    const context = await (await browser()).newContext({ viewport: { width: 640, height: 480 }, colorScheme: "light", ...options });
    await serveBuiltViewer(context, new URL(url).origin);
    const watched = new WatchedPage();
    watched.context = context;
    watched.page = await context.newPage();
    watched.#watch(new URL(url).host);
    await prepare(watched.page);
    await watched.page.goto(url);
    return watched;
  }

  /// Faults whose text matches are part of the test.
  expect(pattern) {
    this.#expected.push(pattern);
  }

  #watch(host) {
    const fault = (text) => this.#faults.push(text);
    this.page.on("console", (message) => {
      if (["error", "warning"].includes(message.type()) && !isDriverNoise(message.text()))
        fault(`${message.type()}: ${message.text()} (${message.location().url})`);
    });
    this.page.on("pageerror", (error) => fault(`thrown: ${error.stack ?? error.message}`));
    this.page.on("filechooser", () => {}); // from the first on, choosing files is the test's
    this.page.on("websocket", (socket) =>
      socket.on("framesent", ({ payload }) => {
        if (payload.includes("ListSessions")) ++this.#lists;
      }),
    );
    this.page.on("crash", () => fault("the page has crashed"));
    this.page.on("request", (request) => {
      const { protocol, host: asked } = new URL(request.url());
      if (!["data:", "blob:"].includes(protocol) && asked !== host) fault(`asked ${request.url()}`);
    });
  }

  /// How often the page has asked for the list of sessions.
  get lists() {
    return this.#lists;
  }

  /// Moves the page's clock on, which open() has to have been given: `prepare: (page) => page.clock.install()`.
  async pass(seconds) {
    await this.page.clock.fastForward(1000 * seconds);
    await this.#framesPassed();
  }

  /// Moves the page's clock on until the list of sessions was asked for twice more: the first answer is shown by then.
  async listedAgain() {
    for (const wanted = this.#lists + 2; this.#lists < wanted;) await this.pass(1);
  }

  /// Fails where the page has done anything wrong since the last call.
  assertFine() {
    const faults = this.#faults.filter((text) => !this.#expected.some((pattern) => pattern.test(text)));
    this.#faults = [];
    assert.deepEqual(faults, [], "errors, warnings, and requests to elsewhere");
  }

  async close() {
    this.assertFine();
    await this.context.close();
  }

  /// Waits until `condition(c, argument)` holds in the page, c being window.curvecast.
  async until(condition, argument) {
    try {
      return await this.page.waitForFunction(withHandle(condition), argument ?? null, { timeout: 180_000 });
    } catch (error) {
      if (!/Timeout/.test(error.message)) throw error;
      const now = await this.page.evaluate(() => ({
        state: window.curvecast?.state,
        look: window.curvecast?.look,
        settings: window.curvecast?.settings,
        points: window.curvecast?.store?.count,
        last: window.curvecast?.statistics?.last,
        text: document.body.innerText.slice(0, 500),
      }));
      throw new Error(`waited in vain for ${condition}: ${JSON.stringify(now)}`);
    }
  }

  /// Until the newest view has been answered, and all of its points are there; better ones may follow.
  async answered() {
    await this.#framesPassed();
    await this.until(
      ({ statistics, look, settings, store }) =>
        statistics?.last?.sequence === look && (settings.budget !== "points" || store.count === settings.points),
    );
  }

  /// As answered(), and nothing better is to come.
  async settled() {
    await this.answered();
    await this.until((c) => c.state === "streaming" && c.statistics.last.sequence === c.look && !c.statistics.last.refining);
  }

  /// Views leave the page with the next frame.
  async #framesPassed() {
    await this.page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  }

  /// What `ask(c, argument)` returns in the page.
  evaluate(ask, argument) {
    return this.page.evaluate(withHandle(ask), argument ?? null);
  }

  /// Does something that has to ask for another view, and waits for its points.
  async change(how) {
    const before = await this.evaluate((c) => c.look);
    await how();
    await this.until((c, look) => c.look > look, before);
    await this.answered();
  }

  /// Sets what in the panel begins with `label`: a number, true or false, the text of a choice; a button is pressed.
  async set(label, value = null) {
    const found = await this.page.evaluate(
      ([name, wanted]) => {
        const row = [...document.querySelectorAll(".lil-gui .controller")].find((each) =>
          each.querySelector(".name, button")?.textContent.startsWith(name),
        );
        const control = row?.querySelector("select, input, button");
        if (control instanceof HTMLSelectElement) {
          control.selectedIndex = [...control.options].findIndex(({ text }) => text === wanted);
          if (control.selectedIndex < 0) return false;
          control.dispatchEvent(new Event("change"));
        } else if (control instanceof HTMLInputElement && control.type === "checkbox") {
          if (control.checked !== wanted) control.click();
        } else if (control instanceof HTMLInputElement) {
          control.value = String(wanted);
          control.dispatchEvent(new Event("input"));
        } else {
          control?.click();
        }
        return control !== undefined && control !== null;
      },
      [label, value],
    );
    assert.ok(found, `the panel has "${label}"${value === null ? "" : `, to be set to ${value}`}`);
  }

  /// Moves the pointer, with a button pressed, through points of the page, in CSS pixels.
  async drag(path, button = "left") {
    const { mouse } = this.page;
    await mouse.move(...path[0]);
    await mouse.down({ button });
    for (const point of path.slice(1)) await mouse.move(...point, { steps: 4 });
    await mouse.up({ button });
  }

  /// The picture without any points.
  async emptyPicture() {
    const bytes = await this.#png(async () => {
      const { view, store, uniformStore } = window.curvecast;
      view.setStores(null);
      const blob = await view.screenshot();
      if (uniformStore === null) view.setStores(store);
      else view.setStores(uniformStore, store);
      return blob;
    });
    return decode(bytes);
  }

  /// The picture without what is written over it, with all its pixels. `name`: keeps a copy of it.
  async picture(name) {
    return decode(await this.#png(() => window.curvecast.view.screenshot()), name);
  }

  /// The bytes of a blob that `take` returns in the page.
  async #png(take) {
    const text = await this.page.evaluate(
      new Function(`return (${take})().then((blob) => new Promise((done) => {
      const reader = new FileReader();
      reader.onload = () => done(reader.result);
      reader.readAsDataURL(blob);
    }));`),
    );
    return Buffer.from(text.slice(text.indexOf(",") + 1), "base64");
  }

  /// The page as a visitor sees it.
  async screenshot(name) {
    await this.page.screenshot({ path: pictureFile(name) });
  }
}

/// A function for the page: of the argument alone, the handle before it; null while there is no handle.
function withHandle(ask) {
  return new Function("argument", `return window.curvecast ? (${ask})(window.curvecast, argument) : null;`);
}

/// Chromium's own remarks about drawing without a graphics card.
function isDriverNoise(text) {
  return /GPU stall due to ReadPixels|GL Driver Message/.test(text);
}
