// SPDX-License-Identifier: Apache-2.0
// The labels of annotations over the picture.

import type { Viewport } from "../../view";
import { distance } from "../../view/vector";
import { element } from "../elements";
import { drawLabel } from "./draw_label";
import type { Mark } from "./mark";

const restMilliseconds = 200; // without a move, after which is found out what the surface hides
const reach = 2; // radii of the disc in front: a place nearer than that to it is on it

/// Writes numbers and texts beside their places. Those who have the page read out find them in the panel's list.
export class MarkLabels {
  private readonly root = element("div", { class: "marks", attributes: { "aria-hidden": "true" } });
  private labels: { mark: Mark; label: HTMLElement }[] = [];
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(
    page: HTMLElement,
    private readonly viewport: Pick<Viewport, "placeOf" | "pick">,
  ) {
    page.append(this.root);
  }

  show(marks: readonly Mark[]): void {
    this.labels = marks.map((mark, i) => {
      const number = element("b", { text: String(i + 1) });
      return { mark, label: element("div", {}, mark.text === "" ? [number] : [number, element("span", { text: mark.text })]) };
    });
    this.root.replaceChildren(...this.labels.map(({ label }) => label));
    this.place();
  }

  /// Moves the labels to where their places are in the picture. To be called whenever camera, points or the picture's size
  /// have changed.
  place(): void {
    if (this.labels.length === 0) return;
    for (const { mark, label } of this.labels) {
      const at = this.viewport.placeOf(mark.place);
      label.hidden = at === null;
      if (at !== null) label.style.transform = `translate(${at.x.toFixed(1)}px, ${at.y.toFixed(1)}px)`;
    }
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.hide(), restMilliseconds);
  }

  /// Draws them over a picture of the moment, in CSS pixels.
  draw(context: CanvasRenderingContext2D): void {
    this.hide();
    for (const { mark, label } of this.labels) {
      const at = this.viewport.placeOf(mark.place);
      if (at !== null) drawLabel(context, label, at);
    }
  }

  /// Has labels be faint whose places the surface hides.
  private hide(): void {
    for (const { mark, label } of this.labels) {
      const at = this.viewport.placeOf(mark.place);
      const front = at && this.viewport.pick(at.x, at.y);
      label.classList.toggle("behind", front !== null && distance(front.point, mark.place) > reach * front.radius);
    }
  }
}
