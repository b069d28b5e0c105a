// The viewer's files from a folder instead of those in the command, so that a change of the viewer needs no build of the command:
//   (cd client/web && npm run build -- --outDir FOLDER --emptyOutDir) && CURVECAST_VIEWER_FILES=FOLDER node tests/client/web/viewer_test.mjs

import { createHash } from "node:crypto";
import { existsSync, readFileSync } from "node:fs";
import { extname, join } from "node:path";

const folder = process.env.CURVECAST_VIEWER_FILES;
const types = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm" };

/// Flags of Chromium: it does not know that these files come from this machine, whose sockets they may open.
export const builtViewerFlags = folder === undefined ? [] : ["--disable-features=LocalNetworkAccessChecks"];

/// The hash of the script that stands in a page itself, as a policy allows it.
function hashOf(page) {
  const [, script] = /<script type="module" async>([^]*?)<\/script>/.exec(readFileSync(page, "utf8"));
  return `'sha256-${createHash("sha256").update(script).digest("base64")}'`;
}

/// Answers a context's requests for files of `origin` from CURVECAST_VIEWER_FILES, with the headers of the server; without it, nothing.
export async function serveBuiltViewer(context, origin) {
  if (folder === undefined) return;
  const page = await fetch(`${origin}/`);
  const policy = page.headers.get("content-security-policy") ?? "";
  const headers = { "content-security-policy": policy.replace(/'sha256-[^']*'/, hashOf(join(folder, "index.html"))) };
  await context.route(`${origin}/**`, (route) => {
    const { pathname } = new URL(route.request().url());
    const path = join(folder, pathname === "/" ? "index.html" : pathname);
    return existsSync(path) ? route.fulfill({ path, headers, contentType: types[extname(path)] }) : route.fallback();
  });
}
