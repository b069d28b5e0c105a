// SPDX-License-Identifier: Apache-2.0
// The questions that a page asks before it can show anything: the server answers while the rest of the page loads.

import type { Client, Session } from "../stream";

/// The answers under way.
export interface FirstAnswers {
  sessions: Promise<Session[]>;
  session: Promise<Session> | null; // that the page's address names; null where it names none
}

/// Asks for the list of sessions, and for the session that the page's address names.
export function askFirst(client: Client, sessionId: string | null): FirstAnswers {
  const answers = { sessions: client.listSessions(), session: sessionId === null ? null : client.getSession(sessionId) };
  // Those who await an answer later take its error.
  answers.sessions.catch(() => {});
  answers.session?.catch(() => {});
  return answers;
}
