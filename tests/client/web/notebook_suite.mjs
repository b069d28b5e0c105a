// What the Python client shows in notebooks, in a page as Jupyter makes one: the HTML of cells as it is.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { after, before, describe, it } from "node:test";

import { command } from "./support/environment.mjs";
import { bumpyTorus } from "./support/meshes.mjs";
import { drawn, openFile, packageSite } from "./support/package_site.mjs";
import { Server, temporaryFolder } from "./support/server.mjs";

// What a cell shows of a session, and a point set, whose names are not to become elements of the page.
const cells = `import sys
import numpy as np
import curvecast
address, viewer, session, element = sys.argv[1:]
client = curvecast.connect(address, viewer=viewer)
if element:
    print(curvecast.notebook.live(element)._repr_html_())
print(client.session(session)._repr_html_())
name = "<script>document.title = 'hurt'</script><img src=x onerror=\\"document.title = 'hurt'\\">"
points = client.session(session).sample(2000)
print(curvecast.Points(points.origin, points.positions, scalars={name: np.zeros(2000, "<f4")})._repr_html_())
`;

const python = process.env.CURVECAST_PYTHON ?? "/usr/bin/python3"; // has grpcio and numpy

let folder, server;
before(async () => {
  const { folder: made, site } = await packageSite();
  folder = made;
  const mesh = join(temporaryFolder(), "torus <b>.off");
  writeFileSync(mesh, bumpyTorus());
  server = await Server.start("--open", mesh, "--max-curve-vertices", "0", "--web-origin", site.origin);
});
after(() => server?.stop());

/// A page with the cells. `element`: its file, or "".
async function openNotebook(name, element) {
  const program = join(temporaryFolder(), "cells.py");
  writeFileSync(program, cells);
  const written = execFileSync(python, ["-B", program, server.grpc, server.url, server.sessions[0], element], {
    encoding: "utf8",
    env: { ...process.env, PYTHONPATH: join(dirname(command), "client/python") },
    maxBuffer: 1 << 24,
  });
  writeFileSync(join(folder, name), `<!doctype html><title>A notebook</title>${written}`);
  return openFile(name);
}

describe("a notebook", () => {
  it("shows a session live where it has the element", async () => {
    const watched = await openNotebook("live.html", join(folder, "node_modules/curvecast/dist/element.js"));
    await drawn(watched, "curvecast-view", "notebook_live.png");
    const pictures = watched.page.locator("curvecast-view img");
    assert.equal(await pictures.count(), 1);
    assert.equal(await pictures.isVisible(), false); // the live view is in its place
    await watched.close();
  });

  it("shows pictures and tables without it, and text as text", async () => {
    const watched = await openNotebook("pictures.html", "");
    await drawn(watched, "curvecast-view img", "notebook_picture.png");
    await drawn(watched, ":not(curvecast-view) > div > img", "notebook_points.png");
    const { page } = watched;
    assert.equal(await page.locator("img").count(), 2);
    assert.equal(await page.locator("script, b").count(), 0);
    assert.equal(await page.title(), "A notebook");
    assert.equal(await page.locator("caption").first().textContent(), "torus <b>.off");
    const link = await page.locator("a").getAttribute("href");
    assert.equal(link, `${server.url}#session=${server.sessions[0]}`);
    await watched.close();
  });
});
