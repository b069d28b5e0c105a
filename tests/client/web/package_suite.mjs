// What a user of the npm package builds with it: scenes, programs, types.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { copyFileSync, mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { before, describe, it } from "node:test";
import { pathToFileURL } from "node:url";

import { root } from "./support/environment.mjs";
import { consumerModules, writeExample } from "./support/npm_package.mjs";
import { drawn, openFile, packageSite } from "./support/package_site.mjs";

let folder, target;
before(async () => ({ folder, target } = await packageSite()));

describe("the client and the object for three.js", () => {
  it("stream into a scene in a page without a build", async () => {
    writeExample(folder, "three.html", target);
    const watched = await openFile("three.html", { viewport: { width: 320, height: 240 } });
    await drawn(watched, "canvas", "package_three.png", 0.05);
    await watched.close();
  });

  it("have points and triangles as arrays", async () => {
    writeFileSync(join(folder, "blank.html"), "<!doctype html><title>Blank</title>");
    const watched = await openFile("blank.html");
    const { points, wrong, triangles } = await watched.page.evaluate(async ({ url, session, token }) => {
      const { Client, Sampler, socketUrl } = await import("./node_modules/curvecast/dist/curvecast.js");
      const client = new Client({ url: socketUrl(url), token });
      const sample = { budget: { case: "points", value: 20_000n }, sampler: Sampler.PROGRESSIVE };
      const got = await client.resample(session, sample); // on worker threads
      const surface = await client.surface(session); // by draco3d
      const refused = new Client({ url: socketUrl(url), token: "wrong" });
      const wrong = await refused.getSession(session).catch(({ code }) => code);
      for (const each of [client, refused]) each.close();
      return { points: got.points.count, wrong, triangles: surface.triangles.length / 3 };
    }, target);
    assert.deepEqual({ points, wrong, triangles }, { points: 20_000, wrong: "UNAUTHENTICATED", triangles: 2 * 120 * 48 });
    await watched.close();
  });

  it("stream into a scene of react-three-fiber, put together by a bundler", async () => {
    writeExample(folder, "react_three_fiber.tsx", target);
    writeFileSync(join(folder, "main.tsx"), mainOfPage);
    writeFileSync(join(folder, "fiber.html"), fiberPage);
    const { build } = await import(pathToFileURL(join(consumerModules, "vite/dist/node/index.js")));
    await build({
      root: folder,
      configFile: false,
      logLevel: "error",
      esbuild: { jsx: "automatic" },
      build: { outDir: join(folder, "built"), rollupOptions: { input: join(folder, "fiber.html") }, chunkSizeWarningLimit: 5000 },
      base: "./",
    });
    const watched = await openFile("built/fiber.html", { viewport: { width: 320, height: 240 } });
    await drawn(watched, "canvas", "package_fiber.png", 0.05);
    await watched.close();
  });
});

describe("the cells of a notebook", () => {
  it("bring the element, and show a session", async () => {
    copyFileSync(join(root, "client/web/examples/jupyter.py"), join(folder, "jupyter.py"));
    writeFileSync(join(folder, "cells.py"), cells);
    const { url, session, token } = target;
    const written = execFileSync("python3", ["cells.py", session, url, token], {
      cwd: folder,
      encoding: "utf8",
      maxBuffer: 1 << 24,
    });
    writeFileSync(join(folder, "notebook.html"), `<!doctype html><title>A notebook</title>${written}`);
    const watched = await openFile("notebook.html");
    await drawn(watched, "curvecast-view", "package_notebook.png");
    await watched.close();
  });
});

/// Prints what the cells result in. In the place of IPython, whose HTML a notebook puts into its page as it is.
const cells = `import sys, types
sys.modules["IPython"] = types.ModuleType("IPython")
sys.modules["IPython.display"] = types.SimpleNamespace(HTML=str)
from jupyter import begin, show
session, url, token = sys.argv[1:]
print(begin(), show(types.SimpleNamespace(id=session), url, token, points=3000, height="300px"))
`;

const mainOfPage = `import { createRoot } from "react-dom/client";
import { StrictMode } from "react";
import { Page } from "./react_three_fiber";
createRoot(document.querySelector("#root")!).render(<StrictMode><Page /></StrictMode>);
`;
const fiberPage = `<!doctype html>
<title>A page of React</title>
<style>html, body, #root { height: 100%; margin: 0 }</style>
<div id="root"></div>
<script type="module" src="./main.tsx"></script>
`;

const typed = `import { Client, CurvecastError, Sampler, socketUrl, type LiveViewState, type PointStore, type Session } from "curvecast";
import { CurvecastView, type CameraState } from "curvecast/element";
import { CurvecastPoints, defaultStyle } from "curvecast/three";
import * as THREE from "three";

export async function show(scene: THREE.Scene, element: HTMLElement): Promise<PointStore> {
  const client = new Client({ url: socketUrl("https://points.example.org/"), token: "TOKEN" });
  const sessions: Session[] = await client.listSessions();
  const states: LiveViewState[] = [];
  const view = client.view(sessions[0]!.sessionId, { onState: (state) => void states.push(state) });
  view.look({ budget: { case: "points", value: 30_000n }, sampler: Sampler.PROGRESSIVE, density: [{ term: { case: "screen", value: {} } }] });
  // @ts-expect-error: there is no such budget
  view.look({ budget: { case: "pints", value: 30_000n } });
  const points = new CurvecastPoints(view.store);
  points.style = { ...defaultStyle, mode: "dots" };
  scene.add(points);
  const made = document.createElement("curvecast-view");
  made.addEventListener("ready", ({ detail }) => console.log(detail.report?.mesh?.faces));
  made.addEventListener("error", ({ detail }) => console.log(detail.code === "UNAUTHENTICATED", detail instanceof CurvecastError));
  made.addEventListener("click", (event) => console.log(event.clientX));
  const camera: CameraState | null = made instanceof CurvecastView ? made.camera : null;
  if (camera !== null) made.camera = { ...camera, fov: 20 };
  const picture: Blob = await made.screenshot(2);
  // @ts-expect-error: a number is none
  made.camera = picture.size;
  element.append(made);
  return view.store;
}
`;

describe("the types", () => {
  for (const [resolution, module] of [
    ["bundler", "ESNext"],
    ["node16", "Node16"],
  ]) {
    it(`compile strictly where modules are found as by ${resolution}`, () => {
      writeExample(folder, "react_three_fiber.tsx", target);
      mkdirSync(join(folder, "typed"), { recursive: true });
      writeFileSync(join(folder, "typed/typed.ts"), typed);
      writeFileSync(join(folder, "package.json"), JSON.stringify({ type: "module" }));
      const config = join(folder, `tsconfig.${resolution}.json`);
      const compilerOptions = {
        target: "ES2022",
        lib: ["ES2022", "DOM", "DOM.Iterable"],
        module,
        moduleResolution: resolution,
        strict: true,
        jsx: "react-jsx",
        noEmit: true,
        skipLibCheck: false,
        types: [],
      };
      writeFileSync(config, JSON.stringify({ compilerOptions, files: ["typed/typed.ts", "react_three_fiber.tsx"] }));
      assert.equal(compilerOutput(config), "");
    });
  }

  it("are all that modules of a server for pages need: nothing runs where there is no page", () => {
    const script = `import { CurvecastView } from "curvecast/element"; import { socketUrl } from "curvecast"; import { CurvecastPoints } from "curvecast/three";
      console.log(typeof CurvecastView, socketUrl("https://a.example/b/"), typeof CurvecastPoints);`;
    writeFileSync(join(folder, "server.mjs"), script);
    const said = execFileSync(process.execPath, ["server.mjs"], { cwd: folder, encoding: "utf8" });
    assert.equal(said.trim(), "function wss://a.example/b/v1/socket function");
  });
});

/// What tsc says about a project, in which types are looked at, too; nothing, where all is well. Those of other packages are their own
/// affair: some fail by themselves.
function compilerOutput(config) {
  let said = "";
  try {
    execFileSync(process.execPath, [join(consumerModules, "typescript/bin/tsc"), "-p", config], { cwd: folder, encoding: "utf8" });
  } catch (error) {
    said = error.stdout;
  }
  const isOther = (line) => /\/node_modules\/(?!curvecast\/)/.test(line);
  return said
    .split("\n")
    .filter((line) => !isOther(line))
    .join("\n");
}
