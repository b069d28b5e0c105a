// What the tests take from the machine, and how they say that it is not there.

import { existsSync, mkdirSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

const SKIPPED = 77; // what CTest takes for a skipped test

/// The root of the sources, with a slash at its end.
export const root = fileURLToPath(new URL("../../../../", import.meta.url));

export const command = process.env.CURVECAST_COMMAND ?? join(root, "build/release/curvecast");

/// Ends the process as a skipped test.
export function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(SKIPPED);
}

/// A package of tests/client/web/package.json.
function requirePackage(name) {
  const modules = process.env.CURVECAST_NODE_MODULES ?? join(root, "build/playwright/node_modules");
  try {
    return createRequire(join(modules, "x.js"))(name);
  } catch (error) {
    return skip(`${error.message.split("\n")[0]}; deploy/test installs the packages`);
  }
}

export const { chromium } = requirePackage("playwright-core");
export const { PNG } = requirePackage("pngjs");
/// A script that finds what a page keeps from some of its users; it makes `window.axe`.
export const { source: axeSource } = requirePackage("axe-core");

export const browserPath = process.env.CURVECAST_CHROMIUM ?? "/usr/bin/chromium";
if (!existsSync(browserPath)) skip(`there is no ${browserPath}; deploy/setup installs Chromium`);
if (!existsSync(command)) skip(`there is no ${command}; deploy/build builds it`);

/// A mesh that is not part of the project; null where it is missing.
export function sharedMesh(name) {
  const path = join(root, "../shared/meshes", name);
  return existsSync(path) ? path : null;
}

/// Where pictures go that a person may want to look at.
export function pictureFile(name) {
  const folder = process.env.CURVECAST_SCREENSHOTS ?? join(root, "build/screenshots");
  mkdirSync(folder, { recursive: true });
  return join(folder, name);
}
