// SPDX-License-Identifier: Apache-2.0
// The list of the server's sessions, to choose from.

import { asCurvecastError, SessionState, type Client, type Session } from "../stream";
import { button, crossButton, element } from "./elements";
import { bytes, count } from "./format";
import type { Messages } from "./messages";
import type { Thumbnails } from "./thumbnails";

/// What the buttons of a row call.
export interface SessionActions {
  open(session: Session): void;
  forget(session: Session): void;
}

/// Returns the name of a session's mesh, or the beginning of the mesh's id where it has no name yet.
export function nameOf(session: Session): string {
  const name = session.report?.mesh?.name ?? "";
  return name === "" ? session.meshId.slice(0, 8) : name;
}

/// Returns the first session that is ready; null where none is.
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

/// The row of one session.
class Row {
  private readonly name = element("strong");
  private readonly details = element("small");
  private readonly picture = element("img", { attributes: { alt: "" } });
  private readonly open: HTMLButtonElement;
  private readonly forget: HTMLButtonElement;
  readonly root: HTMLElement;

  constructor(
    actions: SessionActions,
    private session: Session,
  ) {
    this.open = button("", () => actions.open(this.session), session.sessionId);
    this.open.append(this.picture, this.name, this.details);
    this.forget = crossButton("", () => actions.forget(this.session));
    this.root = element("div", { class: "session" }, [this.open, this.forget]);
  }

  show(session: Session, isCurrent: boolean, picture: string | null): void {
    this.session = session;
    this.name.textContent = nameOf(session);
    this.details.textContent = detailsOf(session);
    this.picture.hidden = picture === null;
    if (picture !== null && this.picture.src !== picture) this.picture.src = picture;
    this.open.disabled = session.state !== SessionState.READY;
    if (isCurrent) this.open.setAttribute("aria-current", "true");
    else this.open.removeAttribute("aria-current");
    const forgets = `Forget ${nameOf(session)}, on the server too`;
    this.forget.title = forgets;
    this.forget.setAttribute("aria-label", forgets);
  }
}

/// The list. The caller puts `root` into the page.
export class SessionList {
  readonly root = element("div", { class: "sessions" });
  private readonly none = element("p", { text: "none yet" });
  private readonly rows = new Map<string, Row>(); // by their sessions' ids
  private sessions: readonly Session[] = [];
  private currentId: string | null = null;

  constructor(
    private readonly actions: SessionActions,
    private readonly thumbnails: Pick<Thumbnails, "of">,
  ) {}

  show(sessions: readonly Session[]): void {
    this.sessions = sessions;
    this.refresh();
  }

  /// Marks the session that is shown, by its id; null: none is.
  set current(id: string | null) {
    this.currentId = id;
    this.refresh();
  }

  /// Shows the sessions. Rows that stay keep their elements, and so the focus and a press under way.
  private refresh(): void {
    const { rows, root, sessions } = this;
    const gone = new Set(rows.keys());
    for (const session of sessions) {
      const id = session.sessionId;
      gone.delete(id);
      const row = rows.get(id) ?? new Row(this.actions, session);
      rows.set(id, row);
      row.show(session, id === this.currentId, this.thumbnails.of(id));
    }
    for (const id of gone) {
      rows.get(id)!.root.remove();
      rows.delete(id);
    }
    this.none.remove();
    sessions.forEach(({ sessionId }, i) => {
      const row = rows.get(sessionId)!.root;
      if (row !== root.children[i]) root.insertBefore(row, root.children[i] ?? null);
    });
    if (sessions.length === 0) root.append(this.none);
  }
}

/// Has the server forget a session, if the user says so. Returns whether it was asked to.
export async function forgetSession(client: Client, session: Session, messages: Messages): Promise<boolean> {
  if (!confirm(`Forget ${nameOf(session)}, on the server too?`)) return false;
  try {
    await client.closeSession(session.sessionId);
  } catch (thrown) {
    messages.failure(`${nameOf(session)} could not be forgotten`, asCurvecastError(thrown));
  }
  return true;
}
