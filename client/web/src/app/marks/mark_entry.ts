// SPDX-License-Identifier: Apache-2.0
// The field in which the text of an annotation is written.

import { button, element } from "../elements";
import { cleanText, maxText } from "./mark";

/// What the field calls. It is closed afterwards.
export interface EntryActions {
  save(index: number, text: string): void;
  remove(index: number): void;
}

/// One field at most is open, under the picture.
export class MarkEntry {
  private readonly input = element("input", { attributes: { maxlength: String(maxText), autocomplete: "off" } });
  private readonly title = element("label");
  private readonly root: HTMLFormElement;
  private index = 0;
  private focusBefore: Element | null = null; // the element that gets the focus back

  constructor(page: HTMLElement, actions: EntryActions) {
    this.input.id = "mark-text";
    this.title.htmlFor = this.input.id;
    const done = button("Done", () => {});
    done.type = "submit";
    const remove = button("Remove", () => {
      this.close();
      actions.remove(this.index);
    });
    this.root = element("form", { class: "mark-entry" }, [this.title, this.input, done, remove]);
    this.root.hidden = true;
    this.root.addEventListener("submit", (event) => {
      event.preventDefault();
      this.close();
      actions.save(this.index, cleanText(this.input.value));
    });
    this.root.addEventListener("keydown", ({ key }) => key === "Escape" && this.close());
    page.append(this.root);
  }

  /// Opens the field for an annotation, by its place in the list.
  open(index: number, text: string): void {
    if (this.root.hidden) this.focusBefore = document.activeElement;
    this.index = index;
    this.title.textContent = `Annotation ${index + 1}`;
    this.input.value = text;
    this.root.hidden = false;
    this.input.focus();
    this.input.select();
  }

  close(): void {
    if (this.root.hidden) return;
    this.root.hidden = true;
    if (this.focusBefore instanceof HTMLElement) this.focusBefore.focus({ preventScroll: true });
  }
}
