// SPDX-License-Identifier: Apache-2.0
// The keys, and what they do.

import type { StandardView } from "../view";
import { choiceWords } from "./panel_words";
import { withinRange, type Settings } from "./settings";
import type { Shortcut } from "./shortcuts";

/// What keys call. `say`: for those who do not see what a key has changed.
export interface KeyActions {
  change(how: (settings: Settings) => void): void;
  say(text: string): void;
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

type Switch = { [Key in keyof Settings]: Settings[Key] extends boolean ? Key : never }[keyof Settings];

const colourings = Object.entries(choiceWords.colouring);

function scalePoints(settings: Settings, factor: number): void {
  settings.budget = "points";
  settings.points = withinRange("points", Math.round(settings.points * factor));
}

function nextColouring(settings: Settings): string {
  const now = colourings.findIndex(([, value]) => value === settings.colouring);
  const [name, value] = colourings[(now + 1) % colourings.length]!;
  settings.colouring = value;
  return name;
}

function nextMeasure(settings: Settings): string {
  const kinds = Object.values(choiceWords.measure);
  settings.measure = kinds[(kinds.indexOf(settings.measure) + 1) % kinds.length]!;
  return settings.measure;
}

/// Lists all shortcuts of the page.
export function keyTable(actions: KeyActions): Shortcut[] {
  /// `how` returns what to say.
  const sets = (key: string, what: string, how: (settings: Settings) => string, repeats = false): Shortcut => ({
    key,
    what,
    run: () => actions.change((settings) => actions.say(`${what}: ${how(settings)}`)),
    repeats,
  });
  const switches = (key: string, what: string, setting: Switch, also: (settings: Settings) => void = () => {}): Shortcut =>
    sets(key, what, (s) => {
      s[setting] = !s[setting];
      also(s);
      return s[setting] ? "on" : "off";
    });
  return [
    { key: "f", what: "show the whole surface", run: () => actions.fit() },
    { key: "home", what: "the first view", run: () => actions.view("home") },
    { key: "4", what: "from the front", run: () => actions.view("front") },
    { key: "5", what: "from the side", run: () => actions.view("side") },
    { key: "6", what: "from above", run: () => actions.view("top") },
    sets("7", "perspective, orthographic", (s) => (s.projection = s.projection === "perspective" ? "orthographic" : "perspective")),
    { key: "u", what: "open a mesh or points", run: () => actions.upload() },
    sets("1", "discs", (s) => ((s.mode = "splats"), "on")),
    sets("2", "dots", (s) => ((s.mode = "dots"), "on")),
    sets("3", "mesh", (s) => ((s.mode = "mesh"), "on")),
    sets("c", "next colours", nextColouring),
    switches("o", "dark edges", "edl"),
    sets("l", "light, dark", (s) => (s.background = s.background === "light" ? "dark" : "light")),
    sets("[", "half as many points", (s) => (scalePoints(s, 0.5), String(s.points)), true),
    sets("]", "twice as many points", (s) => (scalePoints(s, 2), String(s.points)), true),
    switches("v", "even points beside", "split"),
    switches("z", "hold the points still", "frozen"),
    switches("b", "paint", "brush", (s) => (s.measuring = s.marking = false)),
    switches("r", "rub paint out", "eraser", (s) => ((s.brush = true), (s.measuring = s.marking = false))),
    { key: "mod+z", what: "undo a stroke", run: () => actions.undoStroke(), repeats: true },
    { key: "delete", what: "clear all strokes", run: () => actions.clearStrokes() },
    switches("t", "edges of a mesh", "wireframe"),
    switches("m", "measure", "measuring", (s) => (s.brush = s.marking = false)),
    sets("j", "distance, angle, area", nextMeasure),
    switches("k", "annotate", "marking", (s) => (s.brush = s.measuring = false)),
    sets("n", "orbit, fly", (s) => (s.navigation = s.navigation === "orbit" ? "fly" : "orbit")),
    { key: "p", what: "save the picture", run: () => actions.screenshot() },
    { key: "x", what: "save the points as PLY", run: () => actions.exportPly() },
    { key: "y", what: "copy the link", run: () => actions.copyLink() },
    { key: "g", what: "whole screen", run: () => actions.fullScreen() },
    { key: "h", what: "panel", run: () => actions.togglePanel() },
    { key: "i", what: "figures", run: () => actions.toggleFigures() },
  ];
}
