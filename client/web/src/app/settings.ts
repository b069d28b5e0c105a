// SPDX-License-Identifier: Apache-2.0
// What a user can set. Lengths are in the units of the mesh unless a comment says otherwise.

import type { Background, CameraState, Colouring, MeasureKind, Mode, PaintDab, UpAxis } from "../view";
import type { Unit } from "./format";
import type { Mark } from "./marks/mark";
import { upAxisOf } from "../view/standard_views";

/// A dab of the brush, which paints over what was painted before. Dabs of one `stroke` are alike, and undone together.
export interface Dab extends PaintDab {
  stroke: number;
}

/// All settings of the page.
export interface Settings {
  budget: "points" | "bytes" | "pixels" | "automatic";
  points: number;
  kilobytes: number; // 1,024 bytes
  pixelError: number; // side of the largest square that a point may stand for, pixels
  frameMilliseconds: number; // that a frame of the automatic budget may take
  sampler: "progressive" | "equalised";
  sequence: "jittered" | "regular" | "vanDerCorput" | "goldenRatio"; // of the equalised sampler
  curvature: "none" | "gauss" | "mean" | "max";
  curvatureExponent: number;
  silhouette: boolean;
  silhouetteFloor: number; // s0
  distance: boolean;
  screen: boolean;
  frustum: boolean;
  detail: boolean; // with both of these: more where the picture is wrong without points
  dabs: Dab[];
  brush: boolean; // painting instead of orbiting
  brushSize: number; // radius, % of the diagonal of the mesh's box
  brushFactor: number;
  eraser: boolean; // the brush takes paint away
  wireframe: boolean; // the edges of a mesh over the surface
  meshVertices: number;
  meshForCamera: boolean; // the mesh has the camera's density, too
  mode: Mode;
  colouring: Colouring;
  background: Background;
  edl: boolean;
  dotSize: number; // CSS pixels
  splatScale: number;
  section: "none" | "x" | "y" | "z"; // the axis that the plane which cuts the surface open stands across
  sectionShare: number; // of the surface's box that stays, %
  sectionOther: boolean; // the other half stays
  pixelRatio: number; // most pixels of the picture per CSS pixel
  up: UpAxis;
  fieldOfView: number; // vertical, degrees; that of the camera
  projection: "perspective" | "orthographic"; // of the camera
  pictureScale: number; // of pictures that are saved: pixels per pixel of the page, in each direction
  filmSeconds: number;
  navigation: "orbit" | "fly";
  frozen: boolean; // views are sampled for the camera of the moment when this was set
  split: boolean; // left: a uniform density, right: the one set; both with the same budget
  measuring: boolean;
  measure: MeasureKind; // what clicks measure
  unit: Unit; // of the file's coordinates
  marks: Mark[]; // annotations
  marking: boolean; // clicks add annotations
}

/// The most dabs of the brush; the same limit as the server's.
export const maxDabs = 10_000;

/// The range of a number.
export interface Range {
  min: number;
  max: number;
  step?: number; // of the panel
  isLogarithmic?: boolean; // on the panel's slider
}

/// The ranges of the settings that are numbers.
export const ranges = {
  points: { min: 1000, max: 1_000_000, step: 100, isLogarithmic: true },
  kilobytes: { min: 4, max: 8192, step: 1, isLogarithmic: true },
  pixelError: { min: 1, max: 40, step: 0.5 },
  frameMilliseconds: { min: 10, max: 500, step: 1 },
  curvatureExponent: { min: 0.1, max: 3 },
  silhouetteFloor: { min: 0.01, max: 1 },
  brushSize: { min: 0.5, max: 30 },
  brushFactor: { min: 0, max: 64 },
  meshVertices: { min: 100, max: 100_000, step: 10, isLogarithmic: true },
  dotSize: { min: 1, max: 10 },
  splatScale: { min: 0.2, max: 3 },
  fieldOfView: { min: 5, max: 120, step: 1 },
  sectionShare: { min: 0, max: 100, step: 0.5 },
  pictureScale: { min: 1, max: 8, step: 1 },
  filmSeconds: { min: 1, max: 120, step: 1 },
  pixelRatio: { min: 0.5, max: 4, step: 0.5 },
} satisfies Record<NumberSetting, Range>;

type NumberSetting = { [Key in keyof Settings]: Settings[Key] extends number ? Key : never }[keyof Settings];

/// Returns the value nearest to `value` in the range of a setting.
export function withinRange(key: keyof typeof ranges, value: number): number {
  return Math.min(Math.max(value, ranges[key].min), ranges[key].max);
}

/// Sets what is a camera's to that of `camera`. Returns whether it was something else.
export function takeCamera(settings: Settings, camera: CameraState): boolean {
  const projection = camera.orthographic === true ? "orthographic" : "perspective";
  const taken = { fieldOfView: camera.fov, up: upAxisOf(camera), projection } as const;
  const isNew = taken.fieldOfView !== settings.fieldOfView || taken.up !== settings.up || projection !== settings.projection;
  Object.assign(settings, taken);
  return isNew;
}

/// Returns the settings that a page begins with: surfaces have their own colours, or are clay. A renderer without a graphics card gets fewer points.
export function defaultSettings(isSoftware: boolean, background: Background): Settings {
  return {
    budget: "points",
    points: isSoftware ? 20_000 : 50_000,
    kilobytes: 256,
    pixelError: 3,
    frameMilliseconds: 100,
    sampler: "progressive",
    sequence: "jittered",
    curvature: "none",
    curvatureExponent: 1,
    silhouette: false,
    silhouetteFloor: 0.1,
    distance: false,
    screen: true,
    frustum: true,
    detail: true,
    dabs: [],
    brush: false,
    brushSize: 5,
    brushFactor: 8,
    eraser: false,
    wireframe: false,
    meshVertices: 5000,
    meshForCamera: false,
    mode: "splats",
    colouring: "colour",
    background,
    edl: true,
    dotSize: 2,
    splatScale: 1,
    section: "none",
    sectionShare: 50,
    sectionOther: false,
    pixelRatio: 2,
    up: "y",
    fieldOfView: 30,
    projection: "perspective",
    pictureScale: 1,
    filmSeconds: 10,
    navigation: "orbit",
    frozen: false,
    split: false,
    measuring: false,
    measure: "distance",
    unit: "none",
    marks: [],
    marking: false,
  };
}
