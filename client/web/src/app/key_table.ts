// The keys, and what they do.

import type { StandardView } from "../view";
import { withinRange, type Settings } from "./settings";
import type { Shortcut } from "./shortcuts";

/// What keys call.
export interface KeyActions {
  change(how: (settings: Settings) => void): void;
  fit(): void;
  view(name: StandardView): void;
  fullScreen(): void;
  copyLink(): void;
  upload(): void;
  undoStroke(): void;
  clearStrokes(): void;
  screenshot(): void;
  exportPly(): void;
  togglePanel(): void;
  toggleFigures(): void;
}

const colourings = ["shading", "normal", "curvature", "rank", "density", "colour"] as const;

function scalePoints(settings: Settings, factor: number): void {
  settings.budget = "points";
  settings.points = withinRange("points", Math.round(settings.points * factor));
}

/// Lists all shortcuts of the page.
export function keyTable(actions: KeyActions): Shortcut[] {
  const sets = (key: string, what: string, how: (settings: Settings) => void, repeats = false): Shortcut => ({
    key,
    what,
    run: () => actions.change(how),
    repeats,
  });
  return [
    { key: "f", what: "show the whole surface", run: () => actions.fit() },
    { key: "home", what: "the first view", run: () => actions.view("home") },
    { key: "3", what: "from the front", run: () => actions.view("front") },
    { key: "4", what: "from the side", run: () => actions.view("side") },
    { key: "5", what: "from above", run: () => actions.view("top") },
    { key: "u", what: "open a mesh", run: () => actions.upload() },
    sets("1", "discs", (s) => (s.mode = "splats")),
    sets("2", "dots", (s) => (s.mode = "dots")),
    sets("c", "next colouring", (s) => (s.colouring = colourings[(colourings.indexOf(s.colouring) + 1) % colourings.length]!)),
    sets("o", "eye-dome lighting", (s) => (s.edl = !s.edl)),
    sets("l", "light, dark", (s) => (s.background = s.background === "light" ? "dark" : "light")),
    sets("[", "half as many points", (s) => scalePoints(s, 0.5), true),
    sets("]", "twice as many points", (s) => scalePoints(s, 2), true),
    sets("v", "uniform points beside", (s) => (s.split = !s.split)),
    sets("z", "freeze the sampling camera", (s) => (s.frozen = !s.frozen)),
    sets("b", "brush", (s) => ((s.brush = !s.brush), (s.measuring = false))),
    sets("r", "paint, rub it out", (s) => ((s.eraser = !s.eraser), (s.brush = true), (s.measuring = false))),
    { key: "mod+z", what: "undo a stroke", run: () => actions.undoStroke(), repeats: true },
    { key: "delete", what: "clear all strokes", run: () => actions.clearStrokes() },
    sets("t", "wireframe of a mesh", (s) => (s.wireframe = !s.wireframe)),
    sets("m", "measure", (s) => ((s.measuring = !s.measuring), (s.brush = false))),
    sets("n", "orbit, fly", (s) => (s.navigation = s.navigation === "orbit" ? "fly" : "orbit")),
    { key: "p", what: "save the picture", run: () => actions.screenshot() },
    { key: "x", what: "save the points as PLY", run: () => actions.exportPly() },
    { key: "y", what: "copy the link", run: () => actions.copyLink() },
    { key: "g", what: "whole screen", run: () => actions.fullScreen() },
    { key: "h", what: "panel", run: () => actions.togglePanel() },
    { key: "i", what: "figures", run: () => actions.toggleFigures() },
  ];
}
