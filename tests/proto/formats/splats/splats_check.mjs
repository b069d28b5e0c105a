// splat-transform reads splats, and Spark and PlayCanvas draw them: deploy/check_formats fetches these programs.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, it } from "node:test";

import { curvecast, folder, Packages, rankedPoints, readPly, writeTorus } from "../coloured_points.mjs";
import { compared, within } from "../reader_table.mjs";
import { coverage, maskOf, Studio } from "./drawn.mjs";

const modules = process.env.CURVECAST_NODE_MODULES ?? "build/splats/node_modules";
const packages = new Packages(modules);
const { chromium } = packages.require("playwright-core");
const { PNG } = packages.require("pngjs");
const pictures = process.env.CURVECAST_SCREENSHOTS ?? join(folder, "pictures");
mkdirSync(pictures, { recursive: true });

const COUNT = 20_000;
const [WIDTH, HEIGHT] = [720, 540];
const SPLATS = { "splats.ply": ["--splats"], "splats.spz": [], "splats.glb": ["--splats"] };
const FORMATS = { "splats.ply": ".ply of splats", "splats.spz": ".spz", "splats.glb": ".glb of splats" };
const SPARK = packages.named("@sparkjsdev/spark", "Spark");

/** One sheet of relief, to look through which is to see the background. */
function writeSheet(name) {
  const side = 80;
  const at = (i) => (2 * i) / side - 1;
  let text = "";
  for (let i = 0; i <= side; ++i) {
    for (let k = 0; k <= side; ++k) {
      text += `v ${at(i)} ${0.25 * Math.sin(5 * at(i)) * Math.cos(4 * at(k)) + 0.1 * Math.sin(19 * at(k))} ${at(k)}\n`;
    }
  }
  const corner = (i, k) => i * (side + 1) + k + 1;
  for (let i = 0; i < side; ++i) {
    for (let k = 0; k < side; ++k) text += `f ${corner(i, k)} ${corner(i, k + 1)} ${corner(i + 1, k + 1)} ${corner(i + 1, k)}\n`;
  }
  const path = join(folder, name);
  writeFileSync(path, text);
  return path;
}

function sampleAll(mesh, prefix, sampler = "progressive") {
  const more = sampler === "scattered" ? ["--relax", "3"] : [];
  for (const [name, flags] of Object.entries(SPLATS)) {
    curvecast("sample", mesh, "-n", String(COUNT), "--sampler", sampler, ...more, ...flags, "-o", join(folder, prefix + name));
  }
}

/** The mesh's own picture, drawn once. */
function drawOwn(mesh, name, { eye, up, fov }, target) {
  const path = join(folder, name);
  if (!existsSync(path)) {
    const view = `eye=${eye},target=${target},up=${up},fov=${fov}`;
    curvecast("render", mesh, "--what", "shaded", "--camera", view, "--size", `${WIDTH}x${HEIGHT}`, "-o", path);
  }
  return PNG.sync.read(readFileSync(path));
}

/** Splats as splat-transform reads them. */
function transformed(file) {
  const table = join(folder, "table.csv");
  execFileSync(process.execPath, [
    join(modules, "@playcanvas/splat-transform/bin/cli.mjs"),
    "--quiet",
    "--overwrite",
    join(folder, file),
    table,
  ]);
  const [head, ...rows] = readFileSync(table, "utf8").trim().split("\n");
  const names = head.split(",");
  return rows.map((row) => Object.fromEntries(row.split(",").map((value, i) => [names[i], Number(value)])));
}

const torus = writeTorus("torus.ply");
const points = rankedPoints(torus, "-n", String(COUNT));
sampleAll(torus, "");
after(() => rmSync(folder, { recursive: true }));

describe("splat-transform", () => {
  // It turns .spz, whose y axis is up, about the x axis, into .ply, whose y axis it takes to be down.
  for (const [file, turn, place, width] of [
    ["splats.ply", 1, 1e-6, 1e-5],
    ["splats.spz", -1, 4e-7, 0.033],
  ]) {
    it(`reads ${file}`, () =>
      compared(FORMATS[file], packages.named("@playcanvas/splat-transform", "splat-transform"), "all numbers", () => {
        const splats = transformed(file);
        assert.equal(splats.length, COUNT);
        let worst = 0;
        splats.forEach((splat, i) => {
          const point = points[i];
          const off = [splat.x - point.x, splat.y - turn * point.y, splat.z - turn * point.z];
          worst = Math.max(worst, ...off.map(Math.abs));
          for (const name of ["scale_0", "scale_1"]) assert.ok(Math.abs(splat[name] - Math.log(0.75 * point.radius)) < width);
          for (const [k, channel] of [point.red, point.green, point.blue].entries()) {
            assert.ok(Math.abs(0.5 + 0.28209479 * splat[`f_dc_${k}`] - channel / 255) < 0.004);
          }
          // Where the rotation takes the z axis.
          const { rot_0: w, rot_1: x, rot_2: y, rot_3: z } = splat;
          const axis = [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)];
          const cosine = axis[0] * point.nx + turn * axis[1] * point.ny + turn * axis[2] * point.nz;
          assert.ok(Math.abs(cosine) > 0.9999, `rotation ${i}: ${cosine}`);
        });
        assert.ok(worst <= place, `places are ${worst} away`);
        return `places ${within(worst)}`;
      }));
  }
});

const RENDERERS = [
  ["splats/spark_page.js", "splats.ply", SPARK],
  ["splats/spark_page.js", "splats.spz", SPARK],
  ["splats/playcanvas_page.js", "splats.glb", packages.named("playcanvas", "PlayCanvas")],
];
const OF_TORUS = { eye: [1.2, 2.1, 2.6], target: [0, 0, 0], up: [0, 1, 0], fov: 46 };
const OF_SHEET = { eye: [0.9, 1.9, 2.1], target: [0.05, -0.12, 0.05], up: [0, 1, 0], fov: 48 };
const sheet = writeSheet("sheet.obj");
// The less even points, which are the command's default, have the narrowest splats for their number.
const SCENES = [
  ["torus", torus, "", "progressive", RENDERERS, OF_TORUS],
  ["sheet", sheet, "sheet_", "progressive", RENDERERS, OF_SHEET],
  ["sheet", sheet, "jittered_", "equalised", RENDERERS.slice(1), OF_SHEET],
  ["sheet", sheet, "scattered_", "scattered", RENDERERS.slice(1), OF_SHEET],
];
const CLOSED = { progressive: 0.999, equalised: 0.995, scattered: 0.999 }; // of the mesh's pixels, at least
const BOUND = 1.5; // no point of a scene is farther from the origin

/** How many pixels wide, in standard deviations, the splats of a scene are at most. */
function widest(prefix, { eye, fov }) {
  const width = Math.max(...readPly(join(folder, `${prefix}splats.ply`)).map((splat) => Math.exp(splat.scale_0)));
  const pixels = HEIGHT / (2 * Math.tan((fov * Math.PI) / 360)); // of a unit at the distance of one
  return (width * pixels) / (Math.hypot(...eye) - BOUND);
}

describe("a surface of splats", () => {
  let studio;
  before(async () => {
    for (const [, mesh, prefix, sampler] of SCENES.slice(1)) sampleAll(mesh, prefix, sampler);
    studio = await Studio.open(chromium, PNG, modules, folder);
  });
  after(() => studio?.close());

  for (const [scene, mesh, prefix, sampler, renderers, camera] of SCENES) {
    for (const [script, file, program] of renderers) {
      it(`is closed: ${scene}, ${sampler}, ${file}, ${script}`, (test) =>
        compared(FORMATS[file], program, `pixels of a mesh and of its ${COUNT} splats`, async () => {
          const own = drawOwn(mesh, `${scene}.png`, camera, camera.target);
          const away = camera.eye.map((x, axis) => 2 * x - camera.target[axis]);
          const background = drawOwn(mesh, `${scene}_background.png`, camera, away);
          const { count, picture } = await studio.draw(script, prefix + file, camera, WIDTH, HEIGHT);
          await studio.save(picture, join(pictures, `${scene}_${sampler}_${file.replace(".", "_")}.png`));
          assert.equal(count, COUNT);
          // Where the surface ends, half of a splat stands out; two standard deviations beyond, it is hardly seen.
          const reach = Math.ceil(2 * widest(prefix, camera));
          const { pixels, closed, least, near, beyond } = coverage(picture, maskOf(own, background), reach);
          const [share, out, far] = [closed, near, beyond].map((part) => (100 * part).toFixed(3));
          test.diagnostic(
            `${pixels} pixels of the mesh, ${share} % closed, alpha ${least} at least; half covered: ${out} % beyond the outline, ` +
              `${far} % more than ${reach} pixels beyond it`,
          );
          assert.ok(pixels > 60_000);
          assert.ok(closed > CLOSED[sampler], `${share} % closed`);
          assert.ok(least >= 200);
          assert.equal(beyond, 0);
          return `${scene}, ${sampler}: ${share} % closed`;
        }));
    }
  }
});
