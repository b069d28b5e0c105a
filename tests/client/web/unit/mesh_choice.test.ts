import { describe, expect, it } from "vitest";

import { isDrawnSoon, isMeshSmaller, meshBytes, suitsMesh, viewBytes } from "../../../../client/web/src/app/mesh_choice";
import { defaultSettings, type Settings } from "../../../../client/web/src/app/settings";

const defaults = defaultSettings(false, "light");
const set = (change: Partial<Settings>): Settings => ({ ...defaults, budget: "automatic", ...change });

describe("the mesh instead of points", () => {
  it("is smaller at once where it is small, and later where it is larger", () => {
    const points = 50_000;
    expect(isMeshSmaller(10_000, 0, points)).toBe(true);
    expect(isMeshSmaller(200_000, 0, points)).toBe(false);
    expect(isMeshSmaller(200_000, meshBytes(200_000) - viewBytes(points), points)).toBe(false);
    expect(isMeshSmaller(200_000, meshBytes(200_000) - viewBytes(points) + 1, points)).toBe(true);
  });

  it("is never smaller where it is too large, or not known", () => {
    expect(isMeshSmaller(1_000_000, 1e9, 1000)).toBe(true);
    expect(isMeshSmaller(1_000_001, 1e9, 1000)).toBe(false);
    expect(isMeshSmaller(0, 1e9, 1000)).toBe(false);
  });

  it("is not too much for a processor", () => {
    expect(isDrawnSoon(900_000, false)).toBe(true);
    expect(isDrawnSoon(20_000, true)).toBe(true);
    expect(isDrawnSoon(900_000, true)).toBe(false);
  });

  it.each<[string, Partial<Settings>]>([
    ["of the page's own budget", {}],
    ["as clay", { colouring: "shading" }],
    ["cut open", { section: "x" }],
    ["measured", { measuring: true }],
    ["before another background", { background: "dark", edl: false }],
  ])("suits a picture %s", (_, change) => {
    expect(suitsMesh(set(change), defaults)).toBe(true);
  });

  const dab = { centre: [0, 0, 0], radius: 1, factor: 2, stroke: 0 } satisfies Settings["dabs"][number];
  it.each<[string, Partial<Settings>]>([
    ["of dots", { mode: "dots" }],
    ["of the mesh, which is asked for anyway", { mode: "mesh" }],
    ["of curvatures", { colouring: "curvature" }],
    ["of ranks", { colouring: "rank" }],
    ["of so many points", { budget: "points" }],
    ["of so many bytes", { budget: "bytes" }],
    ["of smaller discs", { splatScale: 0.5 }],
    ["under the brush", { brush: true }],
    ["of a painted density", { dabs: [dab] }],
    ["of another density", { curvature: "mean" }],
    ["of denser outlines", { silhouette: true }],
    ["of points even on the surface", { screen: false }],
    ["of points without detail", { detail: false }],
    ["of the other sampler", { sampler: "equalised" }],
    ["beside another", { split: true }],
    ["of a camera before", { frozen: true }],
  ])("does not suit a picture %s", (_, change) => {
    expect(suitsMesh(set(change), defaults)).toBe(false);
  });
});
