// The panel of settings, made with lil-gui.

import GUI, { type Controller } from "lil-gui";

import type { StandardView } from "../view";
import { button, element } from "./elements";
import guiStyle from "../../node_modules/lil-gui/dist/lil-gui.min.css?inline";
import { ranges, type Settings } from "./settings";

/// What the panel calls: `changed` after a setting has changed, the others for its buttons.
export interface PanelActions {
  changed(): void;
  upload(): void;
  fit(): void;
  view(name: StandardView): void;
  fullScreen(): void;
  copyLink(): void;
  undoStroke(): void;
  clearStrokes(): void;
  screenshot(): void;
  exportPly(): void;
  exportMesh(): void;
  help(): void;
}

// Labels and their values, in the form that lil-gui wants.
const budgets = { points: "points", bytes: "bytes", "error in pixels": "pixels", automatic: "automatic" };
const sequences = { jittered: "jittered", regular: "regular", "van der Corput": "vanDerCorput", "golden ratio": "goldenRatio" };
const curvatures = { "– off": "none", Gaussian: "gauss", mean: "mean", largest: "max" };
const colourings = {
  shading: "shading",
  normal: "normal",
  curvature: "curvature",
  rank: "rank",
  density: "density",
  "mesh's colour": "colour",
};

/// Removes lil-gui's font for a few signs, a data URL that the page's content policy does not allow. Other fonts have these signs, too.
function withoutFonts(style: string): string {
  return style.replace(/@font-face\s*\{[^}]*\}/g, "");
}

/// Shows `settings`, writes to them, and then calls `changed`. `sessions`: the list that stands at the top.
export class Panel {
  private readonly gui: GUI;
  private readonly conditions: { controller: Controller; applies: () => boolean }[] = [];

  constructor(
    private readonly settings: Settings,
    actions: PanelActions,
    sessions: HTMLElement,
  ) {
    document.head.prepend(element("style", { text: withoutFonts(guiStyle) }));
    this.gui = new GUI({ title: "Curvecast", width: 270, injectStyles: false });
    this.gui.onChange(() => {
      this.showWhatApplies();
      actions.changed();
    });
    this.addSessions(sessions, actions);
    this.addView(actions);
    this.addPoints();
    this.addDensity();
    this.addBrush(actions);
    this.addMesh(actions);
    this.addPicture();
    this.addTools(actions);
    this.gui.onOpenClose(() => this.makeRoom());
    if (window.innerWidth < 900) this.gui.close(); // it would cover a part of the picture: see style.css
    this.makeRoom();
    this.showWhatApplies();
  }

  /// Shows settings that were changed elsewhere.
  refresh(): void {
    for (const controller of this.gui.controllersRecursive()) controller.updateDisplay();
    this.showWhatApplies();
  }

  toggle(): void {
    this.gui.show(this.gui._hidden);
    this.makeRoom();
  }

  /// Has the page's style leave room for the panel while it is open.
  private makeRoom(): void {
    document.body.classList.toggle("with-panel", !this.gui._hidden && !this.gui._closed);
  }

  private when(controller: Controller, applies: (settings: Settings) => boolean): void {
    this.conditions.push({ controller, applies: () => applies(this.settings) });
  }

  private showWhatApplies(): void {
    for (const { controller, applies } of this.conditions) controller.show(applies());
  }

  private addNumber(folder: GUI, key: keyof typeof ranges): Controller {
    const { min, max, step }: { min: number; max: number; step?: number } = ranges[key];
    return folder.add(this.settings, key, min, max, step);
  }

  private addSessions(sessions: HTMLElement, actions: PanelActions): void {
    const folder = this.gui.addFolder("Sessions");
    folder.$children.append(sessions);
    folder.add(actions, "upload").name("Open a mesh … (U)");
  }

  private addView(actions: PanelActions): void {
    const s = this.settings;
    const folder = this.gui.addFolder("View");
    const names: [string, StandardView, string][] = [
      ["Home", "home", "The first view (Home)"],
      ["Front", "front", "From the front (3)"],
      ["Side", "side", "From the right side (4)"],
      ["Top", "top", "From above (5)"],
    ];
    const buttons = names.map(([text, view, title]) => button(text, () => actions.view(view), title));
    folder.$children.append(element("div", { class: "views", attributes: { role: "group", "aria-label": "Views" } }, buttons));
    folder.add(actions, "fit").name("Show the whole surface (F)");
    folder.add(s, "up", { Y: "y", Z: "z" }).name("axis that points up");
    this.addNumber(folder, "fieldOfView").name("angle of view, °");
    folder.add(s, "navigation", ["orbit", "fly"]).name("navigation");
  }

  private addPoints(): void {
    const s = this.settings;
    const folder = this.gui.addFolder("Points");
    folder.add(s, "budget", budgets).name("budget");
    this.when(this.addNumber(folder, "points").name("points"), ({ budget }) => budget === "points");
    this.when(this.addNumber(folder, "kilobytes").name("kilobytes"), ({ budget }) => budget === "bytes");
    this.when(this.addNumber(folder, "pixelError").name("pixels per point"), ({ budget }) => budget === "pixels");
    this.when(this.addNumber(folder, "frameMilliseconds").name("ms per frame"), ({ budget }) => budget === "automatic");
    folder.add(s, "sampler", { progressive: "progressive", "equalised (the paper's)": "equalised" }).name("sampler");
    this.when(folder.add(s, "sequence", sequences).name("sequence"), ({ sampler }) => sampler === "equalised");
  }

  private addDensity(): void {
    const s = this.settings;
    const folder = this.gui.addFolder("Density");
    folder.add(s, "screen").name("even on the screen");
    folder.add(s, "frustum").name("in the picture only");
    folder.add(s, "distance").name("less far away");
    folder.add(s, "silhouette").name("silhouettes");
    this.when(this.addNumber(folder, "silhouetteFloor").name("elsewhere (s0)"), ({ silhouette }) => silhouette);
    folder.add(s, "curvature", curvatures).name("curvature");
    this.when(this.addNumber(folder, "curvatureExponent").name("exponent"), ({ curvature }) => curvature !== "none");
    folder.add(s, "split").name("uniform beside it");
    folder.add(s, "frozen").name("freeze its camera");
  }

  private addBrush(actions: PanelActions): void {
    const s = this.settings;
    const folder = this.gui.addFolder("Brush");
    folder.add(s, "brush").name("paint density");
    this.addNumber(folder, "brushSize").name("radius, % of size");
    folder.add(s, "eraser").name("rub paint out (R)");
    this.when(this.addNumber(folder, "brushFactor").name("factor"), ({ eraser }) => !eraser);
    folder.add(actions, "undoStroke").name("Undo a stroke (Ctrl Z)");
    folder.add(actions, "clearStrokes").name("Clear all strokes");
    folder.close();
  }

  private addMesh(actions: PanelActions): void {
    const s = this.settings;
    const folder = this.gui.addFolder("Mesh");
    folder.add(s, "wireframe").name("wireframe (T)");
    this.addNumber(folder, "meshVertices").name("vertices");
    folder.add(s, "meshForCamera").name("for this camera");
    this.when(folder.add(actions, "exportMesh").name("Save the mesh as PLY"), ({ wireframe }) => wireframe);
    folder.close();
  }

  private addPicture(): void {
    const s = this.settings;
    const folder = this.gui.addFolder("Picture");
    folder.add(s, "mode", ["splats", "dots"]).name("draw");
    folder.add(s, "colouring", colourings).name("colour by");
    folder.add(s, "edl").name("eye-dome lighting");
    this.when(this.addNumber(folder, "splatScale").name("size of discs"), ({ mode }) => mode === "splats");
    this.when(this.addNumber(folder, "dotSize").name("size of dots"), ({ mode }) => mode === "dots");
    this.addNumber(folder, "pixelRatio").name("sharpness");
    folder.add(s, "background", ["light", "dark"]).name("background");
  }

  private addTools(actions: PanelActions): void {
    const folder = this.gui.addFolder("Tools");
    folder.add(this.settings, "measuring").name("measure distances");
    folder.add(actions, "screenshot").name("Save the picture (P)");
    folder.add(actions, "exportPly").name("Save the points as PLY (X)");
    folder.add(actions, "copyLink").name("Copy the link (Y)");
    folder.add(actions, "fullScreen").name("Whole screen (G)");
    folder.add(actions, "help").name("Keys (?)");
    folder.close();
  }
}
