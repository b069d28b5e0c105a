// SPDX-License-Identifier: Apache-2.0
// What the page says when the server refuses something, or is gone.

import type { CurvecastError, LiveViewState, Session } from "../stream";
import type { Viewport } from "../view";
import type { Begun } from "./begin";
import type { Messages } from "./messages";
import type { Streams, Which } from "./streams";
import type { Uploads } from "./upload";

const noticeableDelay = 0.3; // seconds; a shorter pause before a reconnection has no banner
const nowhere = "FAILED_PRECONDITION"; // the code of a view whose density is zero everywhere

/// What the page has at the moment.
export interface TroubledPage {
  readonly session: Session | null;
  readonly streams: Streams | null;
  readonly viewport: Viewport;
  readonly uploads: Uploads;
}

/// Tells the user what is wrong, and what can be done.
export class Troubles {
  constructor(
    private readonly page: TroubledPage,
    private readonly messages: Messages,
    private readonly begun: Begun,
  ) {}

  /// The server does not take this caller.
  refused(error: CurvecastError): void {
    if (error.code === "PERMISSION_DENIED") {
      if (this.page.session === null) this.messages.refuse(error);
      else this.messages.failure("The server does not take this page", error);
      return;
    }
    this.messages.askToken(this.begun.token.value === undefined ? null : error.message, (token) => {
      this.begun.token.keep(token);
      location.reload();
    });
  }

  /// A session cannot be shown.
  failed(sessionId: string, error: CurvecastError): void {
    if (error.code !== "NOT_FOUND") this.messages.failure("The session cannot be shown", error);
    else if (this.page.session !== null) this.messages.failure("This session is not there", error);
    else this.missing(sessionId);
  }

  /// The server does not take a view.
  refusedView(error: CurvecastError): void {
    const { viewport } = this.page;
    this.begun.poster.hide();
    viewport.expectNoPoints();
    if (error.code === nowhere) {
      const whole = { text: "Show the whole surface (F)", run: () => viewport.frame() };
      this.messages.showHint("Nothing of the surface is in view here", whole);
    } else this.messages.notice(`The server refused this view: ${error.message}`);
  }

  /// A stream has another state.
  stateChanged(which: Which, state: LiveViewState, error: CurvecastError | null, delay: number | null): void {
    if (state !== "connecting" && state !== "reconnecting") this.messages.hideBanner(which);
    if (state === "reconnecting" && delay !== null && delay > noticeableDelay) {
      this.messages.showBanner(which, `${error?.message ?? "The connection was lost"}. Trying again …`, {
        text: "Try now",
        run: () => this.page.streams?.retryNow(),
      });
    }
    if (state !== "failed" || error === null) return;
    this.begun.poster.hide();
    if (error.code === "UNAUTHENTICATED" || error.code === "PERMISSION_DENIED") this.refused(error);
    else if (error.code === "NOT_FOUND") this.missing(this.page.session?.sessionId ?? "");
    else this.messages.failure(which === "main" ? "The stream has ended" : "The stream of uniform points has ended", error);
  }

  /// The server does not have a session, or has it no longer: one without a cache was restarted.
  private missing(sessionId: string): void {
    const { uploads } = this.page;
    const name = uploads.nameOf(sessionId);
    const again = name === null ? [] : [{ text: `Open ${name} again`, run: () => uploads.again(sessionId) }];
    this.messages.missingSession(sessionId, [...again, { text: "Choose files …", run: () => uploads.pick() }]);
  }
}
