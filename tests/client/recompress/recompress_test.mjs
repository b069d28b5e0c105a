// Files that gltf-transform and gltfpack have compressed give the surface, and so the points, of the originals.
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, describe, it } from "node:test";
import { promisify } from "node:util";
import { torusGlb } from "./torus_glb.mjs";

const SKIPPED = 77; // what CTest takes for a skipped test
const modules = process.env.CURVECAST_NODE_MODULES ?? "";
const programs = {
  transform: path.join(modules, "@gltf-transform/cli/bin/cli.js"),
  pack: path.join(modules, "gltfpack/cli.js"),
};
for (const program of Object.values(programs)) {
  if (fs.existsSync(program)) continue;
  console.log(`skipped: there is no ${program}; deploy/test installs the packages`);
  process.exit(SKIPPED);
}

const folder = fs.mkdtempSync(path.join(os.tmpdir(), "curvecast-recompress-"));
after(() => fs.rmSync(folder, { recursive: true }));
const place = (name) => path.join(folder, name);
const run = promisify(execFile);

async function curvecast(...args) {
  const env = { ...process.env, XDG_CACHE_HOME: place("cache") };
  const { stdout } = await run(process.env.CURVECAST_COMMAND, [...args, "--json"], { maxBuffer: 1 << 26, env });
  return JSON.parse(stdout);
}

/// What shrinks a file, by name: the program and its arguments.
const ways = {
  "gltf-transform draco": ["transform", (from, to) => ["draco", from, to]],
  "gltf-transform draco, sequential": ["transform", (from, to) => ["draco", "--method", "sequential", from, to]],
  "gltf-transform meshopt": ["transform", (from, to) => ["meshopt", from, to]],
  "gltf-transform quantize": ["transform", (from, to) => ["quantize", from, to]],
  "gltf-transform webp": ["transform", (from, to) => ["webp", from, to]],
  "gltf-transform webp and draco": [
    "transform",
    (from, to) => ["optimize", from, to, "--compress", "draco", "--texture-compress", "webp", "--simplify", "false"],
  ],
  "gltfpack -c": ["pack", (from, to) => ["-i", from, "-o", to, "-c"]],
  "gltfpack -cc": ["pack", (from, to) => ["-i", from, "-o", to, "-cc"]],
  "gltfpack -cf, with a fallback": ["pack", (from, to) => ["-i", from, "-o", to, "-cf"]],
};

async function recompress(way, from, to) {
  const [program, args] = ways[way];
  await run(process.execPath, [programs[program], ...args(from, to)]);
  return to;
}

/// The points of a binary .ply file: the mean colour in each octant around the middle, and how many points have one.
function octantColours(file, middle) {
  const bytes = fs.readFileSync(file);
  const end = bytes.indexOf("end_header\n") + "end_header\n".length;
  const header = bytes.toString("latin1", 0, end);
  assert.match(header, /format binary_little_endian/);
  const count = Number(/element vertex (\d+)/.exec(header)[1]);
  const sizes = { float: 4, double: 8, uchar: 1, int: 4, uint: 4, short: 2, ushort: 2, char: 1 };
  const at = {};
  let stride = 0;
  for (const [, type, name] of header.matchAll(/property (\w+) (\w+)\n/g)) {
    at[name] = { type, offset: stride };
    stride += sizes[type];
  }
  const read = (i, name) => {
    const offset = end + i * stride + at[name].offset;
    if (at[name].type === "uchar") return bytes[offset];
    return at[name].type === "double" ? bytes.readDoubleLE(offset) : bytes.readFloatLE(offset);
  };
  const sums = Array.from({ length: 8 }, () => [0, 0, 0, 0]);
  for (let i = 0; i < count; ++i) {
    const octant = ["x", "y", "z"].reduce((bits, axis, k) => bits | (read(i, axis) > middle[k] ? 1 << k : 0), 0);
    ["red", "green", "blue"].forEach((name, k) => (sums[octant][k] += read(i, name)));
    ++sums[octant][3];
  }
  return sums.map(([red, green, blue, points]) => ({
    colour: [red, green, blue].map((sum) => sum / points),
    share: points / count,
  }));
}

/// Fails unless the file's surface is that of the original, within the rounding of its coordinates: 14 bits at least, of which a step
/// is 0.006 % of the longest side.
async function assertSameSurface(original, packed) {
  const { distance } = await curvecast("measure", original, "--mesh", packed);
  assert.ok(distance.max < 0.02, `${distance.max} % of the diagonal apart`);
  const [{ mesh: before, ...wasRepaired }, { mesh: now, ...isRepaired }] = await Promise.all([
    curvecast("info", original),
    curvecast("info", packed),
  ]);
  assert.equal(now.components, before.components);
  assert.equal(now.genus, before.genus);
  assert.equal(now.boundary_loops, before.boundary_loops);
  assert.ok(Math.abs(now.faces - before.faces) <= 0.002 * before.faces, `${now.faces} faces, of ${before.faces}`);
  assert.equal(now.crease_degrees, before.crease_degrees);
  assert.deepEqual(isRepaired.warnings ?? [], wasRepaired.warnings ?? []);
}

describe("a textured torus", async () => {
  const original = place("torus.glb");
  fs.writeFileSync(original, torusGlb());
  const sampled = async (mesh, to) => {
    await curvecast("sample", mesh, "-n", "20000", "-o", to);
    return octantColours(to, [5, 0, 0]);
  };
  for (const way of Object.keys(ways)) {
    it(`comes out of ${way} as it was`, async () => {
      const packed = await recompress(way, original, place("packed.glb"));
      assert.notDeepEqual(fs.readFileSync(packed), fs.readFileSync(original));
      await assertSameSurface(original, packed);
      const before = await sampled(original, place("before.ply"));
      const now = await sampled(packed, place("now.ply"));
      for (let octant = 0; octant < 8; ++octant) {
        assert.ok(
          Math.abs(now[octant].share - before[octant].share) < 0.002,
          `octant ${octant}: ${now[octant].share} of the points`,
        );
        now[octant].colour.forEach((value, k) => {
          const was = before[octant].colour[k];
          assert.ok(Math.abs(value - was) < 4, `octant ${octant}: colour ${k} is ${value}, and was ${was}`);
        });
      }
      const points = fs.readFileSync(place("now.ply"));
      await sampled(packed, place("now.ply"));
      assert.deepEqual(fs.readFileSync(place("now.ply")), points, "the same file gives the same bytes");
    });
  }
});

const scans = path.resolve(process.env.CURVECAST_SOURCE ?? ".", "../shared/meshes");
for (const name of ["spot", "rocker-arm", "stanford-bunny"]) {
  const file = path.join(scans, `${name}.obj`);
  describe(name, { skip: fs.existsSync(file) ? false : `there is no ${file}` }, () => {
    const original = place(`${name}.glb`);
    for (const way of ["gltf-transform draco", "gltf-transform meshopt", "gltf-transform quantize", "gltfpack -cc"]) {
      it(`comes out of ${way} as it was`, async () => {
        if (!fs.existsSync(original)) await run(process.execPath, [programs.pack, "-i", file, "-o", original, "-noq"]);
        await assertSameSurface(original, await recompress(way, original, place(`${name}-packed.glb`)));
      });
    }
  });
}
