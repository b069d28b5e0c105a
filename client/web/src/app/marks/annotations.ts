// SPDX-License-Identifier: Apache-2.0
// Annotations of the surface: added by clicks, written over the picture, listed in the panel, kept in the address.

import type { Vec, Viewport } from "../../view";
import { maxMarks, type Mark } from "./mark";
import { MarkEntry } from "./mark_entry";
import { MarkLabels } from "./mark_labels";
import { MarkList } from "./mark_list";

/// What annotations need of the page.
export interface AnnotationsHost {
  readonly viewport: Viewport;
  /// The annotations have changed.
  changed(): void;
  notice(text: string): void;
}

/// Changes a list of annotations, and shows it. The list itself is the page's.
export class Annotations {
  private readonly labels: MarkLabels;
  private readonly entry: MarkEntry;
  private readonly list = new MarkList({ edit: (index) => this.edit(index), remove: (index) => this.remove(index) });

  constructor(
    page: HTMLElement,
    private readonly marks: Mark[],
    private readonly host: AnnotationsHost,
  ) {
    this.labels = new MarkLabels(page, host.viewport);
    this.entry = new MarkEntry(page, {
      save: (index, text) => {
        const mark = marks[index];
        if (mark !== undefined) mark.text = text;
        this.changed();
      },
      remove: (index) => this.remove(index),
    });
    this.show();
  }

  /// The list for the panel.
  get root(): HTMLElement {
    return this.list.root;
  }

  /// Adds an annotation, whose text is asked for.
  add(place: Vec): void {
    if (this.marks.length >= maxMarks) return this.host.notice(`There are ${maxMarks} annotations at most`);
    this.marks.push({ place, text: "" });
    this.changed();
    this.entry.open(this.marks.length - 1, "");
  }

  /// Adds one in the middle of the picture, for those who do not point.
  addInTheMiddle(): void {
    const { viewport } = this.host;
    const { width, height } = viewport.cssSize;
    const found = viewport.pick(width / 2, height / 2);
    if (found === null) this.host.notice("There is no surface in the middle of the picture");
    else this.add(found.point);
  }

  /// Has the labels follow the camera.
  place(): void {
    this.labels.place();
  }

  /// Draws the labels over a picture of the moment, in CSS pixels.
  readonly draw = (context: CanvasRenderingContext2D): void => this.labels.draw(context);

  clear(): void {
    if (this.marks.length === 0) return;
    this.marks.length = 0;
    this.entry.close();
    this.changed();
  }

  private edit(index: number): void {
    const mark = this.marks[index];
    if (mark === undefined) return;
    this.host.viewport.lookAt(mark.place);
    this.entry.open(index, mark.text);
  }

  private remove(index: number): void {
    this.entry.close();
    this.marks.splice(index, 1);
    this.changed();
  }

  private changed(): void {
    this.show();
    this.host.changed();
  }

  private show(): void {
    this.labels.show(this.marks);
    this.list.show(this.marks);
    this.host.viewport.setMarks(this.marks.map(({ place }) => place));
  }
}
