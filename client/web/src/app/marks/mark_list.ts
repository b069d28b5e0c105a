// SPDX-License-Identifier: Apache-2.0
// The list of annotations in the panel.

import { button, crossButton, element } from "../elements";
import type { Mark } from "./mark";

/// What the buttons of a row call, with its place in the list.
export interface ListActions {
  edit(index: number): void;
  remove(index: number): void;
}

/// The list. The caller puts `root` into the page.
export class MarkList {
  readonly root = element("div", { class: "sessions mark-list" });

  constructor(private readonly actions: ListActions) {}

  show(marks: readonly Mark[]): void {
    const rows = marks.map(({ text }, i) => {
      const edit = button("", () => this.actions.edit(i), "Show it, and change its text");
      edit.append(element("strong", { text: text === "" ? `Annotation ${i + 1}` : `${i + 1} · ${text}` }));
      return element("div", { class: "session" }, [edit, crossButton(`Remove annotation ${i + 1}`, () => this.actions.remove(i))]);
    });
    this.root.replaceChildren(...(rows.length > 0 ? rows : [element("p", { text: "none yet" })]));
  }
}
