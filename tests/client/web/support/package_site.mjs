// Pages of other people with the npm package, and a server that takes them: what its tests have in common.

import { createHash } from "node:crypto";
import { writeFileSync } from "node:fs";
import { join } from "node:path";

import { closeBrowser, WatchedPage } from "./browser.mjs";
import { bumpyTorus } from "./meshes.mjs";
import { installedPackage } from "./npm_package.mjs";
import { decode } from "./pictures.mjs";
import { Server, temporaryFolder } from "./server.mjs";
import { StaticSite } from "./static_site.mjs";

const token = "open sesame";
// What client/web/package/README.md says that a page's policy has to allow, and its own picture.
const policy =
  "default-src 'none'; img-src 'self'; connect-src ws://127.0.0.1:*; worker-src blob:; script-src 'self' 'wasm-unsafe-eval'";

let begun = null;
const running = []; // what has to be stopped, also where the rest could not begin

async function begin() {
  const folder = installedPackage();
  const site = await StaticSite.start(folder);
  running.push(site);
  const strictSite = await StaticSite.start(folder, { "content-security-policy": policy });
  running.push(strictSite);
  const [mesh, tokens] = [join(temporaryFolder(), "torus.off"), join(temporaryFolder(), "tokens")];
  writeFileSync(mesh, bumpyTorus());
  writeFileSync(tokens, `someone ${createHash("sha256").update(token).digest("hex")}\n`);
  const origins = [site, strictSite].flatMap(({ origin }) => ["--web-origin", origin]);
  const server = await Server.start("--open", mesh, "--max-curve-vertices", "0", "--tokens", tokens, ...origins);
  running.push(server);
  return { folder, site, strictSite, server, target: { url: server.url, session: server.sessions[0], token } };
}

/// The folder of a site, the site, the same with a strict policy, a server, and what is to be shown of it: address, session, token.
export function packageSite() {
  return (begun ??= begin());
}

/// At the end of all tests.
export async function endPackageSite() {
  await closeBrowser();
  for (const one of running) await one.stop();
}

/// A page of the site, by the name of its file.
export async function openFile(name, options) {
  const { site } = await packageSite();
  return WatchedPage.open(`${site.origin}/${name}`, options);
}

/// The share of a picture's pixels that are not as their row's first one: backgrounds are alike from left to right.
function shareDrawn(bytes, name) {
  const { data, width, height } = decode(bytes, name);
  let drawn = 0;
  for (let i = 0; i < width * height; ++i) {
    const first = i - (i % width);
    if ([0, 1, 2].some((k) => Math.abs(data[4 * i + k] - data[4 * first + k]) > 24)) ++drawn;
  }
  return drawn / (width * height);
}

/// Waits until a surface is in the picture of what a selector finds. `least`: share of its pixels.
export async function drawn(watched, selector, name, least = 0.1) {
  const found = watched.page.locator(selector);
  for (let share = 0; share < least; share = shareDrawn(await found.screenshot(), name)) watched.assertFine();
}
