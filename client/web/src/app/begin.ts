// SPDX-License-Identifier: Apache-2.0
// The questions that a page asks before it can show anything: the server answers while the rest of the page loads.

import { Client } from "../stream";
import { askFirst, type FirstAnswers } from "./first_answers";
import type { PageToken } from "./page_token";
import type { Poster } from "./poster";

/// What a page has before its larger part.
export interface Begun {
  client: Client;
  answers: FirstAnswers;
  token: PageToken;
  poster: Poster;
}

/// Makes the page's client, and asks.
export function begin(token: PageToken, poster: Poster): Begun {
  const client = new Client({ token: token.value });
  const answers = askFirst(client, new URLSearchParams(location.hash.slice(1)).get("session"));
  return { client, answers, token, poster };
}
