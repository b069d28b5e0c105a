// The npm package, as a user has it.

import { execFileSync } from "node:child_process";
import { copyFileSync, existsSync, mkdirSync, readdirSync, readFileSync, symlinkSync, writeFileSync } from "node:fs";
import { join } from "node:path";

import { root, skip } from "./environment.mjs";
import { temporaryFolder } from "./server.mjs";

/// The packages of tests/client/web/consumer/package.json.
export const consumerModules = process.env.CURVECAST_CONSUMER_MODULES ?? join(root, "build/consumer/node_modules");
const examples = join(root, "client/web/examples");

/// Packs the package, and unpacks it into a folder that has nothing else but what stands beside it in a user's node_modules.
export function installedPackage() {
  if (!existsSync(consumerModules)) skip(`there is no ${consumerModules}; deploy/test installs the packages`);
  const said = execFileSync(join(root, "deploy/npm_package"), { encoding: "utf8" });
  const [, file] = /(build\/npm\/curvecast-.*\.tgz)/.exec(said);
  const folder = temporaryFolder();
  const modules = join(folder, "node_modules");
  mkdirSync(join(modules, "curvecast"), { recursive: true });
  for (const name of readdirSync(consumerModules)) {
    if (!name.startsWith(".")) symlinkSync(join(consumerModules, name), join(modules, name));
  }
  execFileSync("tar", ["-xzf", join(root, file), "-C", join(modules, "curvecast"), "--strip-components", "1"]);
  copyFileSync(join(modules, "curvecast/dist/element.js"), join(folder, "element.js")); // where plain.html has it
  return folder;
}

/// Writes an example into a folder, with a server, a session and a token that there are. `change`: what else is other.
export function writeExample(folder, name, { url, session, token }, change = (text) => text, as = name) {
  const text = readFileSync(join(examples, name), "utf8")
    .replaceAll("https://points.example.org/", url)
    .replaceAll("SESSION", session)
    .replaceAll("TOKEN", token);
  writeFileSync(join(folder, as), change(text));
}
