// SPDX-License-Identifier: Apache-2.0
// What an element says over its picture, in words.

/// What a line is about: one of each kind at most, the first of those here is shown.
const concerns = ["failure", "session", "stream", "graphics", "view"] as const;
type Concern = (typeof concerns)[number];

/// One line over the picture, hidden while there is nothing to say. Those who listen to the page hear it.
export class MessageLine {
  readonly root = document.createElement("p");
  private readonly text = document.createElement("span");
  private readonly button = document.createElement("button");
  private readonly said = new Map<Concern, { text: string; retry: (() => void) | undefined }>();

  constructor() {
    this.root.setAttribute("role", "status");
    this.root.hidden = true;
    this.button.textContent = "Try now";
    this.button.addEventListener("click", () => this.current?.retry?.());
    this.root.append(this.text, this.button);
    this.show();
  }

  /// Says something, or with null nothing any more. `retry`: what a button beside it does.
  say(concern: Concern, text: string | null, retry?: () => void): void {
    if (text === null) this.said.delete(concern);
    else this.said.set(concern, { text: text.charAt(0).toUpperCase() + text.slice(1), retry });
    this.show();
  }

  /// Says nothing any more.
  clear(): void {
    this.said.clear();
    this.show();
  }

  private get current(): { text: string; retry: (() => void) | undefined } | undefined {
    const first = concerns.find((concern) => this.said.has(concern));
    return first && this.said.get(first);
  }

  private show(): void {
    const { current } = this;
    this.root.hidden = current === undefined;
    this.button.hidden = current?.retry === undefined;
    if (current !== undefined && this.text.textContent !== current.text) this.text.textContent = current.text;
  }
}
