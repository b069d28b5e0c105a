// SPDX-License-Identifier: Apache-2.0
// Chooses the session that the page shows: the one of its address or the one that the user chose, as soon as it is ready; else the
// first that is ready.

import { asCurvecastError, SessionState, type Client, type CurvecastError, type Session } from "../stream";
import type { CameraState } from "../view";
import type { FirstAnswers } from "./first_answers";
import { Poller } from "./poller";
import { firstReady, nameOf } from "./session_list";

/// Callbacks, called one at a time. They may call choose() and refresh().
export interface ChoiceEvents {
  /// The list of sessions has come.
  onSessions(sessions: readonly Session[]): void;
  /// The session to show is ready. `camera`: the one of the address; null where there is none.
  onReady(session: Session, camera: CameraState | null): void;
  /// There is no session to show, and none is prepared.
  onNone(): void;
  /// Says what the page waits for; null: nothing any more. `error`: why, where something is wrong.
  onWaiting(text: string | null, error?: CurvecastError): void;
  /// The session that was asked for cannot be shown. No other is shown before the user chooses one.
  onFailure(sessionId: string, error: CurvecastError): void;
  /// The server refuses this caller. Nothing is asked any more before the user chooses a session.
  onRefused(error: CurvecastError): void;
}

const secondsBetweenLists = 5;
const secondsUntilReady = 1; // between questions for a session that is being prepared
const secondsBetweenTries = 2; // while the server cannot be reached
const passing = ["UNAVAILABLE", "CANCELLED", "ABORTED", "DEADLINE_EXCEEDED", "RESOURCE_EXHAUSTED", "DATA_LOSS"];
const refusing = ["UNAUTHENTICATED", "PERMISSION_DENIED"];

/// Asks the server for the list of its sessions, and for the one that is wanted.
export class SessionChoice {
  private wanted: { id: string; camera: CameraState | null } | null = null; // the session to show once it is ready
  private takesFirst = true; // neither the address nor the user has named a session
  private isShowing = false;
  private readonly asking = new Poller((isCurrent) => this.ask(isCurrent));
  private readonly listing = new Poller((isCurrent) => this.list(isCurrent));
  private isRefused = false;

  /// `isVisible`: whether the page is visible; the list is not asked for while it is not.
  constructor(
    private readonly client: Pick<Client, "listSessions" | "getSession">,
    private readonly events: ChoiceEvents,
    private readonly isVisible: () => boolean,
  ) {}

  /// Begins with the session and the camera of the page's address, where it names them.
  start(answers: FirstAnswers, sessionId: string | null, camera: CameraState | null): void {
    if (sessionId !== null) this.want(sessionId, camera, answers.session ?? undefined);
    void this.listing.start((isCurrent) => this.list(isCurrent, answers.sessions));
  }

  /// Shows the session that the user has chosen, once it is ready.
  choose(sessionId: string): void {
    this.want(sessionId, null);
  }

  /// Shows a session that the caller has, now.
  showNow(session: Session): void {
    this.show(session, null);
  }

  /// Waits for no session any more, until the user chooses one: the page shows something else.
  rest(): void {
    this.wanted = null;
    this.takesFirst = false;
    this.isShowing = true;
    this.asking.stop();
    this.events.onWaiting(null);
  }

  /// Asks nothing any more, and calls nothing.
  stop(): void {
    this.asking.stop();
    this.listing.stop();
  }

  /// Asks for the list now.
  refresh(): void {
    if (!this.isRefused) void this.listing.start();
  }

  private want(id: string, camera: CameraState | null, answer?: Promise<Session>): void {
    this.wanted = { id, camera };
    this.takesFirst = false;
    this.events.onWaiting(null);
    void this.asking.start((isCurrent) => this.ask(isCurrent, answer));
  }

  private async ask(isCurrent: () => boolean, answer?: Promise<Session>): Promise<number | null> {
    if (this.wanted === null) return null;
    const { id, camera } = this.wanted;
    let session: Session;
    try {
      session = await (answer ?? this.client.getSession(id));
    } catch (thrown) {
      return isCurrent() ? this.askingFailed(id, asCurvecastError(thrown)) : null;
    }
    if (!isCurrent()) return null;
    if (session.state !== SessionState.READY) {
      this.events.onWaiting(`${nameOf(session)} is being prepared …`);
      return secondsUntilReady;
    }
    this.show(session, camera);
    this.refresh(); // the list may not have the session yet
    return null;
  }

  private askingFailed(id: string, error: CurvecastError): number | null {
    if (passing.includes(error.code)) {
      this.events.onWaiting(tryingAgain(error), error);
      return secondsBetweenTries;
    }
    this.wanted = null;
    this.events.onWaiting(null);
    if (refusing.includes(error.code)) this.refuse(error);
    else this.events.onFailure(id, error);
    return null;
  }

  private async list(isCurrent: () => boolean, answer?: Promise<Session[]>): Promise<number | null> {
    if (answer === undefined && !this.isVisible()) return secondsBetweenLists;
    let sessions: Session[];
    try {
      sessions = await (answer ?? this.client.listSessions());
    } catch (thrown) {
      return isCurrent() ? this.listingFailed(asCurvecastError(thrown)) : null;
    }
    if (!isCurrent()) return null;
    this.events.onSessions(sessions);
    if (this.wanted !== null) return secondsBetweenLists;
    this.events.onWaiting(null);
    if (!this.takesFirst) return secondsBetweenLists;
    const first = firstReady(sessions);
    if (first === null) this.events.onNone();
    else this.show(first, null); // a session of the list has all that getSession() returns
    return secondsBetweenLists;
  }

  private listingFailed(error: CurvecastError): number | null {
    if (refusing.includes(error.code)) {
      this.refuse(error);
      return null;
    }
    // The question for the wanted session, or the stream of the shown one, reports the failure in these cases.
    if (this.wanted !== null || this.isShowing) return secondsBetweenLists;
    this.events.onWaiting(tryingAgain(error), error);
    return secondsBetweenTries;
  }

  private show(session: Session, camera: CameraState | null): void {
    this.wanted = null;
    this.takesFirst = false;
    this.isShowing = true;
    this.events.onWaiting(null);
    this.events.onReady(session, camera);
  }

  private refuse(error: CurvecastError): void {
    this.isRefused = true;
    this.wanted = null;
    this.stop();
    this.events.onWaiting(null);
    this.events.onRefused(error);
  }
}

/// Says that something is tried again after an error.
export function tryingAgain(error: CurvecastError): string {
  return `${error.message}. Trying again …`;
}
