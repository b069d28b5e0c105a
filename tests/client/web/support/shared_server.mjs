// One server with a coloured, bumpy torus, for the tests that do nothing to a server but look.

import { writeFileSync } from "node:fs";
import { join } from "node:path";

import { closeBrowser, WatchedPage } from "./browser.mjs";
import { bumpyTorus } from "./meshes.mjs";
import { Server, temporaryFolder } from "./server.mjs";

let started = null;

async function start() {
  const mesh = join(temporaryFolder(), "torus.off");
  writeFileSync(mesh, bumpyTorus(120, 48, true));
  return Server.start("--open", mesh, "--max-curve-vertices", "0"); // a view's points stay what they are
}

export function sharedServer() {
  return (started ??= start());
}

/// A page of it that shows the torus. `hash`: settings in the address, such as "points=5000"; `options` as of WatchedPage.open.
export async function openTorus(hash = "points=5000", options = {}) {
  const { url } = await sharedServer();
  const page = await WatchedPage.open(`${url}#${hash}`, options);
  await page.settled();
  return page;
}

/// At the end of all tests.
export async function endAll() {
  await closeBrowser();
  await (await started)?.stop();
}
