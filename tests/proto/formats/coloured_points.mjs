// A mesh with colours, points of it by the command, and the same points as the project's own PLY has them, to compare with.

import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const SKIPPED = 77; // what CTest takes for a skipped test

const root = fileURLToPath(new URL("../../../", import.meta.url));
export const command = process.env.CURVECAST_COMMAND ?? join(root, "build/release/curvecast");

/** Ends the process as a skipped test. */
export function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(SKIPPED);
}
if (!existsSync(command)) skip(`there is no ${command}; deploy/build builds it`);

export const folder = mkdtempSync(join(tmpdir(), "curvecast-formats-"));

/** Runs the command. */
export function curvecast(...words) {
  return execFileSync(command, [...words, "--quiet"], { encoding: "utf8", env: { ...process.env, XDG_CACHE_HOME: folder } });
}

/** The packages of a folder of node_modules. */
export class Packages {
  constructor(folder) {
    this.folder = folder;
  }
  /** A package for Node. */
  require(name) {
    try {
      return createRequire(join(this.folder, "x.js"))(name);
    } catch (error) {
      return skip(`${error.message.split("\n")[0]}; deploy/fetch_packages fetches it`);
    }
  }
  /** A package's name and version. */
  named(name, as = name) {
    return `${as} ${JSON.parse(readFileSync(join(this.folder, name, "package.json"), "utf8")).version}`;
  }
  /** A module by its path within the packages. */
  async import(path) {
    const file = join(this.folder, path);
    if (!existsSync(file)) skip(`there is no ${file}; deploy/fetch_packages fetches it`);
    return import(pathToFileURL(file).href);
  }
}

/** Writes a torus about the y axis, coloured along its ring, moved by `far`; returns its path. */
export function writeTorus(name, far = [0, 0, 0]) {
  const [rings, sides] = [48, 24];
  const vertices = [];
  const faces = [];
  for (let i = 0; i < rings; ++i) {
    for (let k = 0; k < sides; ++k) {
      const [u, v] = [(2 * Math.PI * i) / rings, (2 * Math.PI * k) / sides];
      const out = 1 + 0.4 * Math.cos(v);
      const place = [out * Math.cos(u), 0.4 * Math.sin(v), out * Math.sin(u)].map((x, axis) => x + far[axis]);
      const colour = [Math.round(127 + 120 * Math.cos(u)), Math.round(127 + 120 * Math.sin(u)), 40 + 8 * k];
      vertices.push([...place, ...colour].join(" "));
      const [j, l] = [(i + 1) % rings, (k + 1) % sides];
      faces.push(`4 ${i * sides + k} ${i * sides + l} ${j * sides + l} ${j * sides + k}`);
    }
  }
  const coordinates = ["x", "y", "z"].map((axis) => `property double ${axis}\n`).join("");
  const channels = ["red", "green", "blue"].map((channel) => `property uchar ${channel}\n`).join("");
  const header =
    `ply\nformat ascii 1.0\nelement vertex ${vertices.length}\n${coordinates}${channels}` +
    `element face ${faces.length}\nproperty list uchar int vertex_indices\nend_header\n`;
  const path = join(folder, name);
  writeFileSync(path, header + [...vertices, ...faces, ""].join("\n"));
  return path;
}

const READERS = {
  float: [4, (view, at) => view.getFloat32(at, true)],
  double: [8, (view, at) => view.getFloat64(at, true)],
  uchar: [1, (view, at) => view.getUint8(at)],
  uint: [4, (view, at) => view.getUint32(at, true)],
};

/** The vertices of a binary PLY file, each an object by the properties' names. */
export function readPly(path) {
  const bytes = readFileSync(path);
  const end = bytes.indexOf("end_header\n") + "end_header\n".length;
  const header = bytes.subarray(0, end).toString();
  const properties = [...header.matchAll(/property (\w+) (\w+)/g)].map(([, type, name]) => [name, ...READERS[type]]);
  const view = new DataView(bytes.buffer, bytes.byteOffset + end);
  let at = 0;
  return Array.from({ length: Number(/element vertex (\d+)/.exec(header)[1]) }, () =>
    Object.fromEntries(
      properties.map(([name, size, read]) => {
        at += size;
        return [name, read(view, at - size)];
      }),
    ),
  );
}

/** Points of a mesh in the order of their ranks, as the project's own PLY has them. */
export function rankedPoints(mesh, ...words) {
  const path = join(folder, "reference.ply");
  curvecast("sample", mesh, "--sampler", "progressive", "--attributes", "rank", ...words, "-o", path);
  return readPly(path).sort((a, b) => a.rank - b.rank);
}
