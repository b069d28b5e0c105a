// The shaders of the viewer and those of core/render are texts of two languages, desktop GLSL and GLSL ES. What they have in common
// has to stay the same: a change of one of them is a change of both.

import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";

import { discFunctions } from "../../../../client/web/src/view/disc_shaders";
import { shadeFragmentShader } from "../../../../client/web/src/view/shade_shaders";
import { blendFragmentShader, blendVertexShader } from "../../../../client/web/src/view/splat_shaders";

const coreFile = (name: string): string => readFileSync(new URL(`../../../../core/render/${name}`, import.meta.url), "utf8");

const viewerFile = (name: string): string =>
  readFileSync(new URL(`../../../../client/web/src/view/${name}`, import.meta.url), "utf8");

/// Leaves out comments, case, underscores and white space, in which the houses' styles differ.
function plain(text: string): string {
  return text
    .replace(/\/\/.*$/gm, "")
    .replace(/[\s_]+/g, "")
    .toLowerCase();
}

const shapes = [
  // How a disc lies in the picture.
  "if (dot(lean, lean) < 1e-8) lean = cross(view, abs(view.x) < 0.7 ? vec3(1, 0, 0) : vec3(0, 1, 0));",
  "vec3 major = cross(view, lean);",
  // How a thin one is kept.
  "float lost = max(least - radius * abs(facing), 0.0);",
  "minor = radius * minor - (facing < 0.0 ? -lost : lost) * lean;",
  // What backs count.
  "mix(0.002, 1.0, smoothstep(-0.15, 0.15, facing))",
];
const kernels = ["float kernel = t * t * t;", "* kernel;"];
const lights = [
  "const vec3 kKey = normalize(vec3(-0.55, 0.75, 0.70));",
  "const vec3 kFill = normalize(vec3(0.85, 0.10, 0.55));",
  "float d = max((dot(n, light) + wrap) / (1.0 + wrap), 0.0); return d * d * (1.0 - 0.5 * wrap) + d * 0.5 * wrap;",
  "vec3 ambient = mix(vec3(0.13, 0.10, 0.085), vec3(0.27, 0.29, 0.33), up);",
  "vec3(1.18, 1.12, 1.03) * wrapped(n, kKey, 0.15)",
  "vec3(0.14, 0.17, 0.22) * wrapped(n, kFill, 0.3)",
  "float sheen = pow(max(dot(n, normalize(kKey + view)), 0.0), 36.0);",
  "float rim = grazing * grazing * grazing * (0.35 + 0.65 * up);",
  "vec3(0.09, 0.088, 0.085) * sheen + vec3(0.15, 0.16, 0.18) * rim",
  "return normalize(mix(n - 2.0 * facing * view, -n, smoothstep(0.75, 0.95, -facing)));",
  "return mix(12.92 * linear, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, linear));",
];

describe("the shaders of the viewer and of core/render", () => {
  const missing = (text: string, parts: readonly string[]): string[] => parts.filter((part) => !plain(text).includes(plain(part)));

  it("place discs by the same rule", () => {
    expect(missing(coreFile("splat_shaders.h"), shapes)).toEqual([]);
    expect(missing(blendVertexShader, shapes)).toEqual([]);
  });

  it("weigh what discs have by the same kernel", () => {
    expect(missing(coreFile("splat_shaders.h"), kernels)).toEqual([]);
    expect(missing(blendFragmentShader, kernels)).toEqual([]);
  });

  it("end discs at outlines by the same numbers", () => {
    const core = plain(coreFile("disc_outline.cpp"));
    const bends = plain(viewerFile("discs/disc_bends.ts"));
    const numberOf = (text: string, name: string): string | undefined => new RegExp(`${name}=([\\d.]+)f?;`, "i").exec(text)?.[1];
    for (const name of ["nearby", "farthest", "nearest", "flatCosine"]) {
      expect(numberOf(bends, `const${name}`), name).toBeDefined();
      expect(numberOf(bends, `const${name}`), name).toBe(numberOf(core, `floatk${name}`));
    }
    const shader = plain(discFunctions);
    expect(core).toContain("knobodysbend=0.5f,kgrazing=0.5f,kface=0.7f");
    expect(shader).toContain("nobodysbend=0.5");
    expect(shader).toContain("smoothstep(0.5,0.7,abs(facing))");
    expect(core).toContain("kend=0.25f");
    expect(shader).toContain("outline=0.25*facing*facing/bend");
  });

  it("have the same light", () => {
    expect(missing(coreFile("surface_shaders.h"), lights)).toEqual([]);
    expect(missing(shadeFragmentShader, lights)).toEqual([]);
  });
});
