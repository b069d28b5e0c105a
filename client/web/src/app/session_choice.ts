// Which session the page shows: the one of its address or one that was chosen, as soon as it is ready; without, the first that is.

import { asCurvecastError, SessionState, type Client, type CurvecastError, type Session } from "../stream";
import type { CameraState } from "../view";
import type { FirstAnswers } from "./first_answers";
import { Poller } from "./poller";
import { firstReady, nameOf } from "./session_list";

/// Called one at a time. They may call choose() and refresh().
export interface ChoiceEvents {
  onSessions(sessions: readonly Session[]): void;
  /// It is ready, and to be shown; `camera`: from where, null: from anywhere.
  onReady(session: Session, camera: CameraState | null): void;
  /// There is none to show, and none is waited for.
  onNone(): void;
  /// What is waited for; null: nothing any more.
  onWaiting(text: string | null): void;
  /// The session that was asked for cannot be shown. No other is before the user chooses one.
  onFailure(sessionId: string, error: CurvecastError): void;
  /// The server does not take this caller: nothing is asked any more before the user chooses a session.
  onRefused(error: CurvecastError): void;
}

const secondsBetweenLists = 5;
const secondsUntilReady = 1; // between questions whether a session is prepared
const secondsBetweenTries = 2; // where the server cannot be reached
const passing = ["UNAVAILABLE", "CANCELLED", "ABORTED", "DEADLINE_EXCEEDED", "RESOURCE_EXHAUSTED", "DATA_LOSS"];
const refusing = ["UNAUTHENTICATED", "PERMISSION_DENIED"];

/// Asks the server for the list of its sessions, and for the one that is wanted.
export class SessionChoice {
  private wanted: { id: string; camera: CameraState | null } | null = null; // to be shown once it is ready
  private takesFirst = true; // nobody has said which
  private isShowing = false;
  private readonly asking = new Poller((isCurrent) => this.ask(isCurrent));
  private readonly listing = new Poller((isCurrent) => this.list(isCurrent));
  private isRefused = false;

  /// `isVisible`: whether anybody looks at the list.
  constructor(
    private readonly client: Pick<Client, "listSessions" | "getSession">,
    private readonly events: ChoiceEvents,
    private readonly isVisible: () => boolean,
  ) {}

  /// `sessionId`, `camera`: of the page's address.
  start(answers: FirstAnswers, sessionId: string | null, camera: CameraState | null): void {
    if (sessionId !== null) this.want(sessionId, camera, answers.session ?? undefined);
    void this.listing.start((isCurrent) => this.list(isCurrent, answers.sessions));
  }

  /// The user wants this session, whatever was wanted before.
  choose(sessionId: string): void {
    this.want(sessionId, null);
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
    this.refresh(); // it may be new there
    return null;
  }

  private askingFailed(id: string, error: CurvecastError): number | null {
    if (passing.includes(error.code)) {
      this.events.onWaiting(tryingAgain(error));
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
    else this.show(first, null); // the list tells all of it
    return secondsBetweenLists;
  }

  private listingFailed(error: CurvecastError): number | null {
    if (refusing.includes(error.code)) {
      this.refuse(error);
      return null;
    }
    // Else the session that is wanted, or the stream of the one that is shown, tells.
    if (this.wanted !== null || this.isShowing) return secondsBetweenLists;
    this.events.onWaiting(tryingAgain(error));
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
    this.asking.stop();
    this.listing.stop();
    this.events.onWaiting(null);
    this.events.onRefused(error);
  }
}

function tryingAgain(error: CurvecastError): string {
  return `${error.message}. Trying again …`;
}
