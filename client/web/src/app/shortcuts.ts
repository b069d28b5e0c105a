// SPDX-License-Identifier: Apache-2.0
// Runs the shortcuts of keys, and lists them in an overlay.

import { takesKeys } from "../view";
import { element } from "./elements";

/// A shortcut. `key`: as KeyboardEvent.key, in lower case; with "mod+" before it for control or command.
export interface Shortcut {
  key: string;
  what: string;
  run: () => void;
  /// Runs again and again while the key is held down.
  repeats?: boolean;
}

// The gestures and keys that the picture takes by itself.
const pointer: readonly (readonly [string, string])[] = [
  ["drag · one finger", "turn"],
  ["right drag · two fingers", "move"],
  ["wheel · pinch", "nearer, farther"],
  ["double click", "look there"],
  ["W A S D, Q E", "fly, when flying"],
  ["arrows, + −", "turn, nearer, farther"],
];

/// Listens to keys until the page ends, but not to those in fields.
export class Shortcuts {
  private readonly overlay = element("div", { class: "help" });
  private focusBefore: Element | null = null; // the element that gets the focus back

  constructor(
    parent: HTMLElement,
    private readonly shortcuts: readonly Shortcut[],
  ) {
    this.overlay.hidden = true;
    this.overlay.tabIndex = -1;
    this.overlay.setAttribute("role", "dialog");
    this.overlay.setAttribute("aria-modal", "true");
    this.overlay.setAttribute("aria-label", "Keys");
    this.overlay.addEventListener("click", () => this.toggleHelp());
    this.overlay.addEventListener("keydown", (event) => this.pressInHelp(event));
    const rows = [...shortcuts.map(({ key, what }) => [keyName(key), what] as const), ["?", "this list"] as const, ...pointer];
    this.overlay.append(
      element("div", { class: "sheet" }, [
        element("h2", { text: "Keys and gestures" }),
        element(
          "dl",
          {},
          rows.flatMap(([key, what]) => [element("dt", {}, [element("kbd", { text: key })]), element("dd", { text: what })]),
        ),
      ]),
    );
    parent.append(this.overlay);
    window.addEventListener("keydown", (event) => this.press(event), { capture: true }); // on their way down: the panel stops its keys on their way up
  }

  /// Shows or hides the overlay. The overlay takes the focus, and gives it back.
  toggleHelp(): void {
    const { overlay } = this;
    overlay.hidden = !overlay.hidden;
    if (!overlay.hidden) {
      this.focusBefore = document.activeElement;
      overlay.focus();
    } else if (this.focusBefore instanceof HTMLElement) this.focusBefore.focus({ preventScroll: true });
  }

  /// Takes the keys while the overlay is open: see takesKeys(). The overlay has nothing else for the focus to go to.
  private pressInHelp(event: KeyboardEvent): void {
    if (event.key === "Tab") event.preventDefault();
    if (event.key === "Escape" || (event.key === "?" && !event.repeat)) this.toggleHelp();
  }

  private press(event: KeyboardEvent): void {
    if (event.altKey || takesKeys(event.target)) return;
    const key = (event.ctrlKey || event.metaKey ? "mod+" : "") + event.key.toLowerCase();
    if (key === "?" && !event.repeat) return this.toggleHelp();
    if (key === "escape" && !this.overlay.hidden) return this.toggleHelp();
    const found = this.shortcuts.find((shortcut) => shortcut.key === key);
    if (found === undefined) return;
    event.preventDefault();
    if (!event.repeat || found.repeats === true) found.run();
  }
}

function keyName(key: string): string {
  return key
    .replace("mod+", "Ctrl ")
    .replace("delete", "Del")
    .replace("home", "Home")
    .replace(/\b[a-z]$/, (letter) => letter.toUpperCase());
}
