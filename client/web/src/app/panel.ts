// SPDX-License-Identifier: Apache-2.0
// The panel of settings, made with lil-gui: first what everybody wants, then, folded, what some want.

import GUI, { type Controller } from "lil-gui";

import type { StandardView } from "../view";
import { button, element } from "./elements";
import guiStyle from "../../node_modules/lil-gui/dist/lil-gui.min.css?inline";
import { makeLogarithmic, movedByFactors } from "./log_slider";
import { makeSlider, moved } from "./panel_access";
import { actionWords, choiceWords, settingWords, type Words } from "./panel_words";
import { isForThePicture } from "./sample_request";
import { ranges, type Range, type Settings } from "./settings";

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
  film(): void;
  addFilmView(): void;
  clearFilmViews(): void;
  exportPly(): void;
  exportMesh(): void;
  addMark(): void;
  clearMarks(): void;
  help(): void;
}

const views: readonly (readonly [text: string, view: StandardView, title: string])[] = [
  ["Home", "home", "The first view (Home)"],
  ["Front", "front", "From the front (4)"],
  ["Side", "side", "From the right side (5)"],
  ["Top", "top", "From above (6)"],
];

/// Removes lil-gui's font for a few signs, a data URL that the page's content policy does not allow. Other fonts have these signs, too.
function withoutFonts(style: string): string {
  return style.replace(/@font-face\s*\{[^}]*\}/g, "");
}

/// Names a row, and explains it.
function explained(controller: Controller, { name, hint }: Words): Controller {
  controller.name(name);
  controller.domElement.title = hint;
  for (const control of controller.domElement.querySelectorAll("input, select, button, .slider")) {
    control.setAttribute("aria-description", hint);
  }
  return controller;
}

/// The lists that have a place in the panel.
export interface PanelLists {
  sessions: HTMLElement; // stands at the top
  marks: HTMLElement;
}

/// Shows `settings`, writes to them, and then calls `changed`.
export class Panel {
  private readonly gui: GUI;
  private readonly conditions: { controller: Controller; applies: () => boolean }[] = [];
  private readonly ofSessions: (GUI | Controller)[] = []; // what is of no use for points of a file
  private readonly sliders: (() => void)[] = []; // tell them of their values

  constructor(
    page: HTMLElement,
    private readonly settings: Settings,
    private readonly actions: PanelActions,
    lists: PanelLists,
  ) {
    document.head.prepend(element("style", { text: withoutFonts(guiStyle) }));
    this.gui = new GUI({ title: "Curvecast", width: 300, injectStyles: false });
    page.append(element("aside", { attributes: { "aria-label": "Settings" } }, [this.gui.domElement]));
    this.gui.onChange(() => {
      this.showWhatApplies();
      actions.changed();
    });
    this.addSessions(lists.sessions);
    this.addView();
    this.addLook();
    this.addPoints();
    this.addSaving();
    this.addFilm();
    this.addMarks(lists.marks);
    this.addDensity();
    this.addBrush();
    this.addMesh();
    this.addSection();
    this.addSampling();
    this.gui.onOpenClose(() => this.makeRoom());
    if (!document.body.classList.contains("with-panel")) this.gui.close(); // see first.ts
    this.makeRoom();
    this.showWhatApplies();
  }

  /// Shows settings that were changed elsewhere.
  refresh(): void {
    for (const controller of this.gui.controllersRecursive()) controller.updateDisplay();
    this.showWhatApplies();
  }

  /// Whether a session is shown, and not points of a file.
  set isOfSession(is: boolean) {
    for (const part of this.ofSessions) part.show(is);
  }

  toggle(): void {
    this.gui.show(this.gui._hidden);
    this.makeRoom();
  }

  /// Has the page's style leave room for the panel while it is open.
  private makeRoom(): void {
    document.body.classList.toggle("with-panel", !this.gui._hidden && !this.gui._closed);
  }

  private when(applies: (settings: Settings) => boolean, controller: Controller): void {
    this.conditions.push({ controller, applies: () => applies(this.settings) });
  }

  private showWhatApplies(): void {
    for (const { controller, applies } of this.conditions) controller.show(applies());
    for (const show of this.sliders) show();
  }

  private folder(title: string, isOpen: boolean): GUI {
    const folder = this.gui.addFolder(title);
    return isOpen ? folder : folder.close();
  }

  private addNumber(folder: GUI, key: keyof typeof ranges): Controller {
    const { min, max, step, isLogarithmic = false }: Range = ranges[key];
    const controller = explained(folder.add(this.settings, key, min, max, step), settingWords[key]);
    const steps = { min, max, step: step ?? (max - min) / 100 };
    if (isLogarithmic) makeLogarithmic(controller, steps);
    this.sliders.push(makeSlider(controller, steps, isLogarithmic ? movedByFactors : moved));
    return controller;
  }

  private addChoice(folder: GUI, key: keyof typeof choiceWords): Controller {
    return explained(folder.add(this.settings, key, choiceWords[key]), settingWords[key]);
  }

  private addSwitch(folder: GUI, key: keyof typeof settingWords): Controller {
    return explained(folder.add(this.settings, key), settingWords[key]);
  }

  private addButton(folder: GUI, key: keyof typeof actionWords): Controller {
    return explained(folder.add(this.actions, key), actionWords[key]);
  }

  private addSessions(sessions: HTMLElement): void {
    const folder = this.folder("Surfaces", true);
    folder.$children.append(sessions);
    this.addButton(folder, "upload");
  }

  private addView(): void {
    const folder = this.folder("View", true);
    const buttons = views.map(([text, view, title]) => button(text, () => this.actions.view(view), title));
    folder.$children.append(element("div", { class: "views", attributes: { role: "group", "aria-label": "Views" } }, buttons));
    this.addButton(folder, "fit");
    this.addChoice(folder, "up");
    this.addChoice(folder, "projection");
    this.when(({ projection }) => projection === "perspective", this.addNumber(folder, "fieldOfView"));
    this.addChoice(folder, "navigation");
  }

  private addLook(): void {
    const folder = this.folder("Look", true);
    this.addChoice(folder, "mode");
    this.addChoice(folder, "colouring");
    this.addChoice(folder, "background");
    this.addSwitch(folder, "edl");
    this.when(({ mode }) => mode === "splats", this.addNumber(folder, "splatScale"));
    this.when(({ mode }) => mode === "dots", this.addNumber(folder, "dotSize"));
    this.addNumber(folder, "pixelRatio");
  }

  private addPoints(): void {
    const folder = this.folder("Number of points", true);
    this.ofSessions.push(folder);
    this.addChoice(folder, "budget");
    this.when(({ budget }) => budget === "points", this.addNumber(folder, "points"));
    this.when(({ budget }) => budget === "bytes", this.addNumber(folder, "kilobytes"));
    this.when(({ budget }) => budget === "pixels", this.addNumber(folder, "pixelError"));
    this.when(({ budget }) => budget === "automatic", this.addNumber(folder, "frameMilliseconds"));
  }

  private addSaving(): void {
    const folder = this.folder("Measure, save, share", true);
    this.addSwitch(folder, "measuring");
    this.addChoice(folder, "measure");
    this.addChoice(folder, "unit");
    this.addButton(folder, "screenshot");
    this.addNumber(folder, "pictureScale");
    this.addButton(folder, "exportPly");
    this.ofSessions.push(this.addButton(folder, "copyLink"));
    for (const key of ["fullScreen", "help"] as const) this.addButton(folder, key);
  }

  private addFilm(): void {
    const folder = this.folder("Film", false);
    for (const key of ["addFilmView", "clearFilmViews"] as const) this.addButton(folder, key);
    this.addNumber(folder, "filmSeconds");
    this.addButton(folder, "film");
  }

  private addMarks(marks: HTMLElement): void {
    const folder = this.folder("Annotations", false);
    this.addSwitch(folder, "marking");
    folder.$children.append(marks);
    this.addButton(folder, "addMark");
    this.addButton(folder, "clearMarks");
  }

  private addDensity(): void {
    const folder = this.folder("Where the points go", false);
    this.ofSessions.push(folder);
    for (const key of ["screen", "frustum"] as const) this.addSwitch(folder, key);
    this.when(isForThePicture, this.addSwitch(folder, "detail"));
    for (const key of ["distance", "silhouette"] as const) this.addSwitch(folder, key);
    this.when(({ silhouette }) => silhouette, this.addNumber(folder, "silhouetteFloor"));
    this.addChoice(folder, "curvature");
    this.when(({ curvature }) => curvature !== "none", this.addNumber(folder, "curvatureExponent"));
    this.addSwitch(folder, "split");
    this.addSwitch(folder, "frozen");
  }

  private addBrush(): void {
    const folder = this.folder("Paint the density", false);
    this.ofSessions.push(folder);
    this.addSwitch(folder, "brush");
    this.addNumber(folder, "brushSize");
    this.addSwitch(folder, "eraser");
    this.when(({ eraser }) => !eraser, this.addNumber(folder, "brushFactor"));
    this.addButton(folder, "undoStroke");
    this.addButton(folder, "clearStrokes");
  }

  private addMesh(): void {
    const folder = this.folder("Mesh of the points", false);
    this.ofSessions.push(folder);
    this.addSwitch(folder, "wireframe");
    this.addNumber(folder, "meshVertices");
    this.addSwitch(folder, "meshForCamera");
    this.when(({ wireframe }) => wireframe, this.addButton(folder, "exportMesh"));
  }

  private addSection(): void {
    const folder = this.folder("Cut open", false);
    this.addChoice(folder, "section");
    this.when(({ section }) => section !== "none", this.addNumber(folder, "sectionShare"));
    this.when(({ section }) => section !== "none", this.addSwitch(folder, "sectionOther"));
  }

  private addSampling(): void {
    const folder = this.folder("Advanced", false);
    this.ofSessions.push(folder);
    this.addChoice(folder, "sampler");
    this.when(({ sampler }) => sampler === "equalised", this.addChoice(folder, "sequence"));
  }
}
