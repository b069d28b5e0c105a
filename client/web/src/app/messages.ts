// SPDX-License-Identifier: Apache-2.0
// What the page says to its user: notices for a moment, a banner while something is wrong, a card where nothing can be shown.

import type { CurvecastError } from "../stream";
import { button, crossButton, element } from "./elements";

/// A button of a message.
export interface Action {
  text: string;
  run: () => void;
}

/// What a banner is about.
export type Concern = "session" | "main" | "uniform" | "graphics" | "film";

const noticeSeconds = 5;
const maxNotices = 4;

/// Shows one banner and one card at most. Notices go by themselves. A message that is shown already is not shown twice.
export class Messages {
  private readonly notices = element("div", { class: "notices" });
  private readonly banner = element("div", { class: "banner" });
  private readonly card = element("div", { class: "card" });
  private readonly hint = element("div", { class: "hint", attributes: { role: "status" } });
  private readonly spoken = element("div", { class: "unseen", attributes: { role: "status" } });
  private readonly shown = new Map<string, { notice: HTMLElement; timer?: ReturnType<typeof setTimeout> }>(); // oldest first
  private readonly concerns = new Map<Concern, { text: string; action: Action | undefined }>(); // the newest is shown
  private bannerText = ""; // of the banner and its button
  private cardText: string | null = null;

  constructor(parent: HTMLElement) {
    this.notices.setAttribute("role", "status");
    this.banner.setAttribute("role", "alert");
    this.banner.hidden = this.card.hidden = this.hint.hidden = true;
    parent.append(this.notices, this.banner, this.card, this.hint, this.spoken);
  }

  /// Has those who listen to the page hear something that others see.
  say(text: string): void {
    this.spoken.textContent = text;
  }

  /// Shows a notice for a few seconds.
  notice(text: string): void {
    if (!this.shown.has(text)) this.addNotice(text, element("div", { class: "notice", text }));
    const entry = this.shown.get(text)!;
    clearTimeout(entry.timer);
    entry.timer = setTimeout(() => this.removeNotice(text), 1000 * noticeSeconds);
  }

  /// Shows a failure until the user closes it.
  failure(what: string, error: CurvecastError): void {
    const text = `${what}: ${error.message}`;
    if (this.shown.has(text)) return;
    this.addNotice(
      text,
      element("div", { class: "notice failure" }, [
        element("div", {}, [element("strong", { text: what }), element("span", { text: error.message })]),
        crossButton("Close", () => this.removeNotice(text)),
      ]),
    );
  }

  /// Shows a banner until hideBanner().
  showBanner(about: Concern, text: string, action?: Action): void {
    this.concerns.set(about, { text, action });
    this.refreshBanner();
  }

  /// Shows a banner, or with null hides it.
  setBanner(about: Concern, text: string | null): void {
    if (text === null) this.hideBanner(about);
    else this.showBanner(about, text);
  }

  hideBanner(about: Concern): void {
    if (this.concerns.delete(about)) this.refreshBanner();
  }

  /// Shows what to do next, until hideHint(). Nothing is wrong.
  showHint(text: string, action: Action): void {
    if (!this.hint.hidden) return;
    this.hint.replaceChildren(element("span", { text }), button(action.text, action.run));
    this.hint.hidden = false;
  }

  hideHint(): void {
    this.hint.hidden = true;
  }

  hideCard(): void {
    this.card.hidden = true;
    this.cardText = null;
  }

  /// Shows a card that asks for a mesh.
  invite(pick: () => void): void {
    this.showCard(
      "Drop a mesh here, or points",
      "PLY, OBJ, OFF, STL, glTF, GLB or 3MF, together with its materials and textures. It is prepared once; " +
        "then its points follow your camera. Point clouds (PLY without faces, XYZ, PTS, LAS) are shown as they are, " +
        "and are not sent to the server.",
      () => [button("Choose files …", pick)],
    );
  }

  /// Shows that the server does not have a session (any more), and ways out.
  missingSession(id: string, actions: readonly Action[]): void {
    this.showCard(
      "This session is not there",
      `The server does not have, or has no longer, the session ${id}. Choose another in the panel, or open the mesh again.`,
      () => [
        element(
          "div",
          { class: "actions" },
          actions.map(({ text, run }) => button(text, run)),
        ),
      ],
    );
  }

  /// Shows that the browser cannot draw.
  noWebGL2(): void {
    this.showCard(
      "This browser shows no WebGL 2",
      "Curvecast draws with WebGL 2. Switch hardware acceleration on, or try another browser.",
    );
  }

  /// Asks the user for a token, and calls `use` with it. `why`: what is wrong with the token before; null where there was none.
  askToken(why: string | null, use: (token: string) => void): void {
    const isNew = this.showCard(
      "The server asks who you are",
      `${why === null ? "" : `Sorry: ${why}. `}Enter the token that you were given; it stays in this tab.`,
      () => [tokenForm(use)],
    );
    if (isNew) this.card.querySelector("input")?.focus();
  }

  /// Shows that the server refuses this page, whatever its user does.
  refuse(error: CurvecastError): void {
    this.showCard("The server does not take this page", error.message);
  }

  private addNotice(text: string, notice: HTMLElement): void {
    const [oldest] = this.shown.keys();
    if (oldest !== undefined && this.shown.size >= maxNotices) this.removeNotice(oldest);
    this.shown.set(text, { notice });
    this.notices.append(notice);
  }

  private removeNotice(text: string): void {
    const entry = this.shown.get(text);
    clearTimeout(entry?.timer);
    entry?.notice.remove();
    this.shown.delete(text);
  }

  private refreshBanner(): void {
    const newest = [...this.concerns.values()].at(-1);
    this.banner.hidden = newest === undefined;
    if (newest === undefined) return;
    const all = `${newest.text} ${newest.action?.text ?? ""}`;
    if (all === this.bannerText) return;
    this.bannerText = all;
    this.banner.replaceChildren(element("span", { text: newest.text }));
    if (newest.action !== undefined) this.banner.append(button(newest.action.text, newest.action.run));
  }

  /// Shows a card. A card of the same text stays as it is, with what was typed into it. Returns whether the card is new.
  private showCard(title: string, text: string, makeParts: () => readonly Node[] = () => []): boolean {
    if (this.cardText === title + text) return false;
    this.cardText = title + text;
    this.card.replaceChildren(element("h2", { text: title }), element("p", { text }), ...makeParts());
    this.card.hidden = false;
    return true;
  }
}

function tokenForm(use: (token: string) => void): HTMLFormElement {
  const input = element("input");
  input.type = "password";
  input.autocomplete = "off";
  input.placeholder = "Token";
  input.setAttribute("aria-label", "Token");
  const submit = button("Continue", () => {});
  submit.type = "submit";
  const form = element("form", {}, [input, submit]);
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    if (input.value.trim() !== "") use(input.value.trim());
  });
  return form;
}
