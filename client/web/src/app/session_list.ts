// The server's sessions, as a list to choose from.

import { SessionState, type Session } from "../stream";
import { button, element } from "./elements";
import { bytes, count } from "./format";

/// What a row of the list can be asked to do.
export interface SessionActions {
  open(session: Session): void;
  forget(session: Session): void;
}

/// The name of a session's mesh, as far as it is known.
export function nameOf(session: Session): string {
  return session.report?.mesh?.name || session.meshId.slice(0, 8);
}

/// The session to show when none is asked for: the first that is ready.
export function firstReady(sessions: readonly Session[]): Session | null {
  return sessions.find((session) => session.state === SessionState.READY) ?? null;
}

function detailsOf(session: Session): string {
  switch (session.state) {
    case SessionState.READY:
      return [
        `${count(Number(session.report?.mesh?.faces ?? 0n))} faces`,
        bytes(Number(session.memoryBytes)),
        ...(session.refining ? ["refining"] : []),
      ].join(" · ");
    case SessionState.QUEUED:
      return "waits for its turn";
    default:
      return "is being prepared";
  }
}

/// `root` is to be put somewhere.
export class SessionList {
  readonly root = element("div", { class: "sessions" });

  constructor(private readonly actions: SessionActions) {}

  show(sessions: readonly Session[], current: string | null): void {
    this.root.replaceChildren(...sessions.map((session) => this.row(session, session.sessionId === current)));
    if (sessions.length === 0) this.root.append(element("p", { text: "none yet" }));
  }

  private row(session: Session, isCurrent: boolean): HTMLElement {
    const open = button("", () => this.actions.open(session), session.sessionId);
    open.append(element("strong", { text: nameOf(session) }), element("small", { text: detailsOf(session) }));
    open.disabled = session.state !== SessionState.READY;
    if (isCurrent) open.setAttribute("aria-current", "true");
    const forget = button("×", () => this.actions.forget(session), `Forget ${nameOf(session)}, on the server too`);
    return element("div", { class: "session" }, [open, forget]);
  }
}
