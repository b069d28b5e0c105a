import { create, toBinary } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";

import { Brush } from "../../../../client/web/src/app/brush";
import { meshRequest, sampleRequest } from "../../../../client/web/src/app/sample_request";
import { defaultSettings, maxDabs, type Settings } from "../../../../client/web/src/app/settings";
import {
  CurvatureKind,
  PointAttribute,
  Sampler,
  SampleRequestSchema,
  Sequence,
} from "../../../../client/web/src/gen/curvecast/v1/curvecast_pb";
import type { CameraState } from "../../../../client/web/src/view/types";

const camera = { eye: [0, 1, 5], target: [0, 0, 0], up: [0, 1, 0], fov: 30 } as const;
const size = { width: 640.4, height: 480 };

function settings(changes: Partial<Settings> = {}): Settings {
  return { ...defaultSettings(false, "light"), dabs: [], ...changes };
}

function request(changes: Partial<Settings> = {}, uniform = false, mostPoints = 0) {
  const { eye, target, up, fov } = camera;
  return create(
    SampleRequestSchema,
    sampleRequest(settings(changes), { eye: [...eye], target: [...target], up: [...up], fov }, size, uniform, mostPoints),
  );
}

const terms = (changes: Partial<Settings>, uniform = false) => request(changes, uniform).density.map(({ term }) => term.case);

describe("a request", () => {
  it("asks for 50,000 progressive points of the picture, 20,000 without a graphics card", () => {
    const sample = request();
    expect(sample.budget).toEqual({ case: "points", value: 50_000n });
    expect(sample.sampler).toBe(Sampler.PROGRESSIVE);
    expect(sample.density.map(({ term }) => term.case)).toEqual(["picture"]);
    expect(sample.cameras[0]).toMatchObject({ eye: { x: 0, y: 1, z: 5 }, up: { x: 0, y: 1, z: 0 }, verticalFovDegrees: 30 });
    expect(sample.viewport).toMatchObject({ width: 640, height: 480 });
    expect(defaultSettings(true, "dark")).toMatchObject({ points: 20_000, background: "dark" });
  });

  it("has an orthographic camera of the height that is seen at the target", () => {
    const { eye, target, up, fov } = camera;
    const flat: CameraState = { eye: [...eye], target: [...target], up: [...up], fov, orthographic: true };
    const asked = create(SampleRequestSchema, sampleRequest(settings(), flat, size)).cameras[0]!;
    expect(asked.orthographicHeight).toBeCloseTo(2 * Math.sqrt(26) * Math.tan((15 * Math.PI) / 180), 9);
    expect(asked.verticalFovDegrees).toBe(0);
  });

  it("has the budget that was chosen", () => {
    expect(request({ budget: "bytes", kilobytes: 64 }).budget).toEqual({ case: "maxBytes", value: 65_536n });
    expect(request({ budget: "pixels", pixelError: 9 }).budget).toEqual({ case: "pixelError", value: 9 });
    expect(request({ budget: "automatic", frameMilliseconds: 50 }).budget).toMatchObject({
      case: "automatic",
      value: { frameSeconds: 0.05 },
    });
  });

  it("has the terms that were chosen, with their values", () => {
    const sample = request({ curvature: "mean", curvatureExponent: 2, silhouette: true, silhouetteFloor: 0.3, distance: true });
    expect(sample.density.map(({ term }) => term.case)).toEqual(["curvature", "view", "distance", "picture"]);
    expect(sample.density[0]!.term.value).toMatchObject({ kind: CurvatureKind.MEAN, exponent: 2 });
    expect(sample.density[1]!.term.value).toMatchObject({ s0: 0.3 });
  });

  it("is even on the screen where no detail is wanted, or not all of it is for one picture", () => {
    expect(terms({ detail: false })).toEqual(["screen", "frustum"]);
    expect(terms({ frustum: false })).toEqual(["screen"]);
    expect(terms({ screen: false })).toEqual(["frustum"]);
  });

  it("is the same for every camera where nothing depends on it", () => {
    const still = { screen: false, frustum: false };
    expect(request(still).cameras).toEqual([]);
    expect(request(still).viewport).toBeUndefined();
    expect(request({}, true).cameras).toEqual([]);
    expect(request({ ...still, budget: "pixels" }).cameras.length).toBe(1);
    expect(terms({ curvature: "max" }, true)).toEqual([]);
  });

  it("has points on the insides of a surface that is cut open", () => {
    expect(terms({ section: "x" })).toEqual(["distance", "frustum"]);
    expect(terms({ section: "x", distance: true })).toEqual(["distance", "frustum"]);
    expect(terms({ section: "x", screen: false })).toEqual(["frustum"]);
  });

  it("knows how many points can be drawn", () => {
    expect(request({ budget: "automatic" }, false, 30_000).budget.value).toMatchObject({ maxPoints: 30_000n });
  });

  it("asks for what colours are made of", () => {
    expect(request().attributes).toEqual([]);
    expect(request({ colouring: "curvature" }).attributes).toEqual([PointAttribute.CURVATURES]);
    expect(request({ colouring: "rank" }).attributes).toEqual([PointAttribute.RANK]);
    expect(request({ colouring: "rank", sampler: "equalised" }).attributes).toEqual([]);
    expect(request({ sequence: "goldenRatio" }).sequence).toBe(Sequence.GOLDEN_RATIO);
  });

  it("paints with one term, stroke by stroke", () => {
    const dab = (stroke: number, x: number, factor: number) => ({
      centre: [x, 2, 3] as [number, number, number],
      radius: 1,
      factor,
      stroke,
    });
    const dabs = [dab(0, 1, 4), dab(0, 1.5, 4), dab(0, 2, 4), dab(1, 1, 1)];
    expect(terms({ dabs, curvature: "gauss" }).filter((name) => name === "brush").length).toBe(1);
    expect(terms({ dabs }, true)).toEqual([]);
    const { term } = request({ dabs }).density.at(-1)!;
    expect(term.case === "brush" && term.value.strokes).toMatchObject([
      { centre: { x: 1, y: 2, z: 3 }, radius: 1, factor: 4, path: [0.5, 0, 0, 1, 0, 0] },
      { centre: { x: 1, y: 2, z: 3 }, radius: 1, factor: 1, path: [] },
    ]);
    const many = Array.from({ length: 1000 }, (_, i) => dab(0, i, 4));
    expect(toBinary(SampleRequestSchema, request({ dabs: many })).length).toBeLessThan(12_500);
  });
});

describe("a request for a mesh", () => {
  const mesh = (changes: Partial<Settings>) => {
    const { eye, target, up, fov } = camera;
    const made = meshRequest(settings(changes), { eye: [...eye], target: [...target], up: [...up], fov }, size);
    return create(SampleRequestSchema, made);
  };
  const dabs = [{ centre: [0, 0, 0] as [number, number, number], radius: 1, factor: 8, stroke: 0 }];

  it("has so many vertices, and the surface's own terms", () => {
    const all = { curvature: "max", silhouette: true, distance: true, dabs } as const;
    const made = mesh({ ...all, dabs, budget: "bytes", colouring: "rank" });
    expect(made.budget).toEqual({ case: "points", value: 5000n });
    expect(made.density.map(({ term }) => term.case)).toEqual(["curvature", "brush"]);
    expect([made.cameras, made.attributes]).toEqual([[], []]);
    expect(mesh({ meshVertices: 70_000 }).budget.value).toBe(70_000n);
  });

  it("has the camera's terms where they are wanted", () => {
    const made = mesh({ meshForCamera: true, silhouette: true, dabs });
    expect(made.density.map(({ term }) => term.case)).toEqual(["view", "picture", "brush"]);
    expect(made.cameras.length).toBe(1);
  });
});

describe("the brush", () => {
  it("leaves dabs apart, until there are enough, and takes strokes back whole", () => {
    const s = settings();
    const notices: string[] = [];
    const brush = new Brush(s, (text) => notices.push(text));
    expect(brush.paint([0, 0, 0], 1, false)).toBe(true);
    expect(brush.paint([0.4, 0, 0], 1, false)).toBe(false);
    expect(brush.paint([1.5, 0, 0], 1, true)).toBe(true);
    expect(brush.paint([1.5, 0, 0], 1, true)).toBe(true); // another stroke, at the same place
    expect(s.dabs.map(({ stroke }) => stroke)).toEqual([0, 0, 1]);
    brush.undo();
    brush.undo();
    expect(s.dabs).toEqual([]);
    for (let i = 0; i < maxDabs + 10; ++i) brush.paint([2 * i, 0, 0], 1, false);
    expect(s.dabs.length).toBe(maxDabs);
    expect(notices.length).toBe(1);
    brush.clear();
    expect(s.dabs).toEqual([]);
    s.brushFactor = 6;
    expect(brush.paint([0, 0, 0], 1, false)).toBe(true);
    s.eraser = true;
    brush.paint([1, 0, 0], 2, true);
    brush.paint([1, 0, 0], 2, true);
    expect(s.dabs.map(({ radius, factor }) => [radius, factor])).toEqual([
      [1, 6],
      [1, 6],
      [2, 1],
    ]);
  });
});
