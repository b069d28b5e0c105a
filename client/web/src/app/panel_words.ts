// SPDX-License-Identifier: Apache-2.0
// What the panel calls the settings, and what it says about each where the pointer rests: the field's own terms among it.

import type { Settings } from "./settings";

/// `name`: on the row. `hint`: beside the pointer, and to those who have the page read out.
export interface Words {
  name: string;
  hint: string;
}

const words = (name: string, hint: string): Words => ({ name, hint });

/// The settings that the panel has.
export const settingWords = {
  up: words("axis that points up", "Files of some programs have Y up, of others Z"),
  projection: words(
    "projection",
    "orthographic: parallels stay parallel, and lengths across the view are the same near and far, as in drawings (7)",
  ),
  fieldOfView: words("angle of view, °", "Vertical field of view: small ones show the surface flat, large ones from near by"),
  navigation: words("moving", "orbit: drag to turn the surface. fly: W A S D Q E move, drag to look around (N)"),
  mode: words(
    "draw as",
    "discs: a closed surface of overlapping points (splats, 1). dots: the points themselves (2). mesh: the surface's own triangles (3)",
  ),
  colouring: words("colours", "What the colours show (C). Surfaces without colours of their own are shown as clay"),
  background: words("background", "Behind the surface (L)"),
  edl: words("dark edges", "Darkens what lies behind an edge, so that shapes stand out: eye-dome lighting (O)"),
  splatScale: words("size of discs", "1: as large as the distance between points. Smaller ones show how the points lie"),
  dotSize: words("size of dots", "Pixels across"),
  section: words("cut across", "Cuts the surface open by a plane across an axis, and shows what is behind it"),
  sectionShare: words("what stays, %", "Where the plane is: how much of the surface's box stays"),
  sectionOther: words("the other half", "Shows the half that was cut off instead"),
  pixelRatio: words("sharpness", "Most pixels of the picture per pixel of the page, on dense screens and when zoomed"),
  budget: words(
    "limit",
    "What bounds the number of points; automatic: the best that line and machine give, which may be the mesh itself",
  ),
  points: words("points", "How many points the picture has ([ halves it, ] doubles it)"),
  kilobytes: words("kilobytes", "Of a picture's points, compressed, as they come over the network"),
  pixelError: words("pixels a point", "Side of the square on the screen that a point may stand for"),
  frameMilliseconds: words("ms per update", "As many points as server, network and drawing manage in that time"),
  screen: words(
    "even as seen from here",
    "Points as far apart on the screen near by as far away: density by the camera's projection",
  ),
  frustum: words("only what is in view", "No points beside the picture: density 0 outside of the camera's frustum"),
  detail: words(
    "more where it shows",
    "At outlines, bends and edges of colour, where the picture is wrong without them: the picture density",
  ),
  distance: words("fewer far away", "Level of detail: the farther from the eye, the fewer, by the square of the distance"),
  silhouette: words("more at outlines", "Where the surface turns away from the eye: the silhouette term of the density"),
  silhouetteFloor: words("rest of the surface", "How dense it is away from the outline: s0; 1 is as dense as there"),
  curvature: words("more at bends", "Where the surface is curved: Gaussian, mean, or the largest principal curvature"),
  curvatureExponent: words("how strongly", "The power of the curvature"),
  split: words(
    "compare with even ones",
    "Beside it the same number of points, spread evenly over the surface: uniform density (V)",
  ),
  frozen: words(
    "hold the points still",
    "Keeps the points of this view, to look at them from elsewhere: freezes the sampling camera (Z)",
  ),
  brush: words("paint with the pointer", "Paints where points are to be dense or sparse (B)"),
  brushSize: words("radius, % of size", "Of the brush, in percent of the diagonal of the surface's box"),
  eraser: words("rub paint out", "The brush takes paint away (R)"),
  brushFactor: words("times as dense", "What the brush paints: 8 for eight times as many points, below 1 for fewer, 0 for none"),
  wireframe: words("show its edges", "A mesh of triangles whose vertices are points of the surface: a wireframe (T)"),
  meshVertices: words("vertices", "How many vertices the mesh has"),
  meshForCamera: words("dense for this view", "The mesh is denser where this camera looks, too, and changes with every turn"),
  sampler: words(
    "points are chosen",
    "by rank: they stay as they are when others come or go. along the curve: as in the paper, all anew",
  ),
  sequence: words("sequence", "How points follow each other along the curve"),
  filmSeconds: words("seconds", "How long the film is, of 30 pictures a second"),
  pictureScale: words("times as large", "Pixels of a saved picture for each pixel of the page, in each direction: for print"),
  marking: words("annotate", "Click the surface to add a numbered place with a text, which the link has, too (K)"),
  measuring: words("measure", "Click points of the surface (M)"),
  measure: words(
    "what",
    "distance: straight, by two clicks. angle: by three, at the second. area: of a flat polygon of clicks, the last on its first (J)",
  ),
  unit: words("unit of the file", "What a length of 1 in the file is: shown with lengths and areas, nothing is converted"),
} satisfies Partial<Record<keyof Settings, Words>>;

/// The values of the settings that are choices, by the words of the panel.
export const choiceWords = {
  up: { Y: "y", Z: "z" },
  projection: { perspective: "perspective", orthographic: "orthographic" },
  navigation: { orbit: "orbit", fly: "fly" },
  mode: { discs: "splats", dots: "dots", mesh: "mesh" },
  colouring: {
    "the surface's own": "colour",
    clay: "shading",
    "directions (normals)": "normal",
    "bends (curvature)": "curvature",
    "order of points (ranks)": "rank",
    density: "density",
  },
  section: { no: "none", X: "x", Y: "y", Z: "z" },
  background: { light: "light", dark: "dark" },
  budget: {
    "number of points": "points",
    "size of data": "bytes",
    "distance on screen": "pixels",
    "speed (automatic)": "automatic",
  },
  measure: { distance: "distance", angle: "angle", area: "area" },
  unit: { "not known": "none", mm: "mm", cm: "cm", m: "m", inches: "in", feet: "ft" },
  curvature: { no: "none", Gaussian: "gauss", mean: "mean", largest: "max" },
  sampler: { "by rank (progressive)": "progressive", "along the curve (paper)": "equalised" },
  sequence: { jittered: "jittered", regular: "regular", "van der Corput": "vanDerCorput", "golden ratio": "goldenRatio" },
} satisfies { [Key in keyof Settings]?: Record<string, Settings[Key]> };

/// The buttons of the panel, by their actions.
export const actionWords = {
  upload: words(
    "Open a mesh or points … (U)",
    "PLY, OBJ, OFF, STL, glTF, GLB or 3MF, with its materials and textures. Point clouds (PLY without faces, XYZ, TXT, ASC, PTS, CSV, " +
      "LAS) are shown as they are, and are not sent to the server. Or drop them on the page",
  ),
  fit: words("Show the whole surface (F)", "From the side that the camera is on"),
  undoStroke: words("Undo a stroke (Ctrl Z)", "Takes back the last stroke of the brush"),
  clearStrokes: words("Clear all strokes (Del)", "Takes back everything that was painted"),
  addMark: words("Annotate the middle", "Adds an annotation in the middle of the picture, for those who do not point"),
  clearMarks: words("Remove all annotations", "What was written is gone"),
  exportMesh: words("Save the mesh as PLY", "The mesh whose edges are shown"),
  screenshot: words("Save the picture (P)", "As PNG, without what is written over it"),
  film: words(
    "Save the film",
    "As WebM: a turn about the surface, or the way past the views that were added. Each picture waits for its points",
  ),
  addFilmView: words("Add this view", "The film passes it, after those that were added before"),
  clearFilmViews: words("Remove the views", "The film is a turn again"),
  exportPly: words("Save the points as PLY (X)", "With normals, radii and colours"),
  copyLink: words("Copy the link (Y)", "The address of this surface, view and settings"),
  fullScreen: words("Whole screen (G)", "Again to leave it"),
  help: words("Keys and gestures (?)", "All of them"),
};
