// Pictures of splats as renderers in a browser draw them, and how much of a surface they cover.

import { once } from "node:events";
import { readFile, writeFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";

const pages = fileURLToPath(new URL("..", import.meta.url));
const browserPath = process.env.CURVECAST_CHROMIUM ?? "/usr/bin/chromium";
const flags = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"];

const EVENING = Date.parse("2026-06-21T18:00:00Z"); // the sun of Cesium stands where it stood then, whenever pictures are made

const IMPORTS = {
  three: "/packages/three/build/three.module.js",
  "three/addons/": "/packages/three/examples/jsm/",
  "@sparkjsdev/spark": "/packages/@sparkjsdev/spark/dist/spark.module.js",
  playcanvas: "/packages/playcanvas/build/playcanvas.mjs",
  "3d-tiles-renderer/three": "/packages/3d-tiles-renderer/build/index.three.js",
};
const TYPES = {
  ".js": "text/javascript",
  ".mjs": "text/javascript",
  ".wasm": "application/wasm",
  ".html": "text/html",
  ".json": "application/json",
};

const pageOf = (script) =>
  `<!doctype html><link rel="icon" href="data:,"><script type="importmap">${JSON.stringify({ imports: IMPORTS })}</script>` +
  `<script type="module" src="/scripts/${script}"></script>`;

/** Serves the pages, the packages and the files to be drawn, to this machine; tells `count` how many bytes of files it sends. */
async function serve(packages, files, count) {
  const folders = { scripts: pages, packages, files };
  const server = createServer(async (request, answer) => {
    try {
      const [, folder, ...path] = request.url.split("/");
      const isPage = folder === "page";
      const body = isPage ? pageOf(path.join("/")) : await readFile(join(folders[folder], normalize(path.join("/"))));
      if (folder === "files") count(body.length);
      answer.setHeader("content-type", TYPES[isPage ? ".html" : extname(request.url)] ?? "application/octet-stream");
      answer.end(body);
    } catch {
      answer.statusCode = 404;
      answer.end();
    }
  });
  server.listen(0, "127.0.0.1");
  await once(server, "listening");
  return server;
}

/** In a page: all dates of now are of this time. Timers go on. */
function stopDate(now) {
  const Real = Date;
  window.Date = class extends Real {
    constructor(...words) {
      super(...(words.length > 0 ? words : [now]));
    }
    static now() {
      return now;
    }
  };
}

/** Draws with Chromium; `packages` and `files` are folders. */
export class Studio {
  static async open(chromium, PNG, packages, files) {
    const studio = new Studio();
    studio.PNG = PNG;
    studio.bytes = 0; // of files that were asked for
    studio.server = await serve(packages, files, (bytes) => (studio.bytes += bytes));
    studio.browser = await chromium.launch({ executablePath: browserPath, args: flags, chromiumSandbox: false });
    return studio;
  }

  /** Draws a file with the page of a renderer. Returns what the page says, and the picture, from the uppermost row down. */
  async draw(script, file, camera, width, height) {
    const page = await this.browser.newPage({ viewport: { width, height } });
    const faults = [];
    page.on("pageerror", (error) => faults.push(String(error)));
    await page.addInitScript(stopDate, EVENING);
    await page.goto(`http://127.0.0.1:${this.server.address().port}/page/${script}`);
    await page.waitForFunction("window.ready", null, { timeout: 60_000 });
    const { pixels, ...said } = await page.evaluate((of) => window.draw(...of), [file, camera, width, height]);
    await page.close();
    if (faults.length > 0) throw new Error(faults.join("\n"));
    const upwards = Buffer.from(pixels, "base64");
    const picture = new this.PNG({ width, height });
    for (let y = 0; y < height; ++y) upwards.copy(picture.data, 4 * width * (height - 1 - y), 4 * width * y, 4 * width * (y + 1));
    return { ...said, picture };
  }

  /** Writes a picture before a background of grey. */
  async save(picture, path) {
    const { width, height } = picture;
    const solid = new this.PNG({ width, height });
    for (let i = 0; i < 4 * width * height; i += 4) {
      const left = 255 - picture.data[i + 3]; // colours are multiplied by alpha already
      for (let c = 0; c < 3; ++c) solid.data[i + c] = Math.min(255, picture.data[i + c] + Math.round((left * 235) / 255));
      solid.data[i + 3] = 255;
    }
    await writeFile(path, this.PNG.sync.write(solid));
  }

  async close() {
    await this.browser.close();
    this.server.close();
  }
}

/** The pixels in which a picture differs from one of the background alone. */
export function maskOf({ data, width, height }, background) {
  return Array.from({ length: width * height }, (_, i) =>
    [0, 1, 2].some((c) => Math.abs(data[4 * i + c] - background.data[4 * i + c]) > 2),
  );
}

/** The pixels of a mask all of whose neighbours within `reach` are of it, too. */
function shrink(mask, width, height, reach) {
  return mask.map((_, i) => {
    const [x, y] = [i % width, Math.floor(i / width)];
    for (let dy = -reach; dy <= reach; ++dy) {
      for (let dx = -reach; dx <= reach; ++dx) {
        const [u, v] = [x + dx, y + dy];
        if (u >= 0 && v >= 0 && u < width && v < height && !mask[v * width + u]) return false;
      }
    }
    return true;
  });
}

/**
 * How a picture of splats covers the pixels of a mesh: of those that lie a pixel within the outline, the share that is opaque to
 * the eye (alpha of 250 of 255 and more) and the least alpha; of those outside, half covered and more, more than two pixels from the
 * outline and more than `reach`, as shares of the mesh's.
 */
export function coverage(picture, mask, reach) {
  const { width, height } = picture;
  const inside = shrink(mask, width, height, 1);
  const outside = mask.map((is) => !is);
  const count = (predicate) => mask.reduce((sum, _, i) => sum + (predicate(i, picture.data[4 * i + 3]) ? 1 : 0), 0);
  const within = count((i) => inside[i]);
  const pixels = count((i) => mask[i]);
  const half = (pixelsAway) => {
    const away = shrink(outside, width, height, pixelsAway);
    return count((i, alpha) => away[i] && alpha >= 128) / pixels;
  };
  return {
    pixels,
    closed: count((i, alpha) => inside[i] && alpha >= 250) / within,
    least: mask.reduce((least, _, i) => (inside[i] ? Math.min(least, picture.data[4 * i + 3]) : least), 255),
    near: half(2),
    beyond: half(reach),
  };
}
