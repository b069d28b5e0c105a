// What a page asks before it can show anything: the server answers while the rest of the page loads.

import type { Client, Session } from "../stream";

export interface FirstAnswers {
  sessions: Promise<Session[]>;
  session: Promise<Session> | null; // the one that the page's address asks for
}

/// Asks at once.
export function askFirst(client: Client, sessionId: string | null): FirstAnswers {
  const answers = { sessions: client.listSessions(), session: sessionId === null ? null : client.getSession(sessionId) };
  // An error is told to those who await the answer, later.
  answers.sessions.catch(() => {});
  answers.session?.catch(() => {});
  return answers;
}
