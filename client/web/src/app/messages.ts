// What the page says: short notices, a banner while something is not right, and a card where nothing can be shown.

import type { CurvecastError } from "../stream";
import { button, element } from "./elements";

interface Action {
  text: string;
  run: () => void;
}

const noticeSeconds = 5;

/// At most one banner and one card; notices go by themselves.
export class Messages {
  private readonly notices = element("div", { class: "notices" });
  private readonly banner = element("div", { class: "banner" });
  private readonly card = element("div", { class: "card" });

  constructor(parent: HTMLElement) {
    this.notices.setAttribute("role", "status");
    this.banner.setAttribute("role", "alert");
    this.banner.hidden = this.card.hidden = true;
    parent.append(this.notices, this.banner, this.card);
  }

  notice(text: string): void {
    const made = element("div", { class: "notice", text });
    this.notices.append(made);
    setTimeout(() => made.remove(), 1000 * noticeSeconds);
  }

  /// Something failed; the user closes it.
  failure(what: string, error: CurvecastError): void {
    const made = element("div", { class: "notice failure" }, [
      element("div", {}, [element("strong", { text: what }), element("span", { text: error.message })]),
      button("×", () => made.remove(), "Close"),
    ]);
    this.notices.append(made);
  }

  showBanner(text: string, action?: Action): void {
    this.banner.replaceChildren(element("span", { text }));
    if (action !== undefined) this.banner.append(button(action.text, action.run));
    this.banner.hidden = false;
  }

  hideBanner(): void {
    this.banner.hidden = true;
  }

  hideCard(): void {
    this.card.hidden = true;
  }

  /// There is no session yet.
  invite(pick: () => void): void {
    this.showCard(
      "Drop a mesh here",
      "PLY, OBJ, OFF, STL, glTF or GLB, together with its materials and textures. It is prepared once; " +
        "then its points follow your camera.",
      [button("Choose files …", pick)],
    );
  }

  /// A session of the address that the server has not.
  missingSession(id: string): void {
    this.showCard(
      "This session is not there",
      `The server knows no session ${id}. Choose another in the panel, or drop a mesh.`,
      [],
    );
  }

  noWebGL2(): void {
    this.showCard(
      "This browser shows no WebGL 2",
      "Curvecast draws with WebGL 2. Switch hardware acceleration on, or try another browser.",
      [],
    );
  }

  /// The server does not take this caller; `use` is given another token. `why`: what is wrong with the one before, if there
  /// was one.
  askToken(why: string | null, use: (token: string) => void): void {
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
    this.showCard(
      "The server asks who you are",
      `${why === null ? "" : `Sorry: ${why}. `}Enter the token that you were given; it stays in this tab.`,
      [form],
    );
    input.focus();
  }

  /// Nothing can be done here about what is wrong.
  refuse(error: CurvecastError): void {
    this.showCard("The server does not take this page", error.message, []);
  }

  private showCard(title: string, text: string, parts: readonly Node[]): void {
    this.card.replaceChildren(element("h1", { text: title }), element("p", { text }), ...parts);
    this.card.hidden = false;
  }
}
