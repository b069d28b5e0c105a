// Keys, and the overlay that lists them.

import { element } from "./elements";

/// A key as KeyboardEvent.key has it, in lower case; "mod+" before it: control or command.
export interface Shortcut {
  key: string;
  what: string;
  run: () => void;
}

// What the picture itself understands.
const pointer: readonly (readonly [string, string])[] = [
  ["drag · one finger", "turn"],
  ["right drag · two fingers", "move"],
  ["wheel · pinch", "nearer, farther"],
  ["double click", "look there"],
  ["W A S D, Q E", "fly, when flying"],
  ["arrows, + −", "turn, nearer, farther"],
];

/// Listens until the page ends. Keys in fields are theirs.
export class Shortcuts {
  private readonly overlay = element("div", { class: "help" });

  constructor(
    parent: HTMLElement,
    private readonly shortcuts: readonly Shortcut[],
  ) {
    this.overlay.hidden = true;
    this.overlay.setAttribute("role", "dialog");
    this.overlay.setAttribute("aria-label", "Keys");
    this.overlay.addEventListener("click", () => (this.overlay.hidden = true));
    const rows = [...shortcuts.map(({ key, what }) => [keyName(key), what] as const), ["?", "this list"] as const, ...pointer];
    this.overlay.append(
      element("div", { class: "sheet" }, [
        element("h1", { text: "Keys and gestures" }),
        element(
          "dl",
          {},
          rows.flatMap(([key, what]) => [element("dt", {}, [element("kbd", { text: key })]), element("dd", { text: what })]),
        ),
      ]),
    );
    parent.append(this.overlay);
    window.addEventListener("keydown", (event) => this.press(event));
  }

  toggleHelp(): void {
    this.overlay.hidden = !this.overlay.hidden;
  }

  private press(event: KeyboardEvent): void {
    if (
      event.altKey ||
      (event.target instanceof HTMLElement && event.target.closest("input, select, textarea, [contenteditable]"))
    )
      return;
    const key = (event.ctrlKey || event.metaKey ? "mod+" : "") + event.key.toLowerCase();
    if (key === "?") return this.toggleHelp();
    if (key === "escape" && !this.overlay.hidden) return this.toggleHelp();
    const found = this.shortcuts.find((shortcut) => shortcut.key === key);
    if (found === undefined) return;
    event.preventDefault();
    found.run();
  }
}

function keyName(key: string): string {
  return key
    .replace("mod+", "Ctrl ")
    .replace("delete", "Del")
    .replace("escape", "Esc")
    .replace(/\b[a-z]$/, (letter) => letter.toUpperCase());
}
