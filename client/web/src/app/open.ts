// Starts the application once the page is loaded.

import type { Client } from "../stream";
import { NoWebGL2Error } from "../view";
import { Application } from "./app";
import type { FirstAnswers } from "./first_answers";
import { handleOf } from "./handle";
import { Messages } from "./messages";

/// Opens the page. `token`: the one that the client has.
export function open(client: Client, answers: FirstAnswers, token: string | undefined): void {
  const canvas = document.querySelector("canvas")!;
  const page = document.querySelector("main")!;
  const messages = new Messages(page);
  try {
    window.curvecast = handleOf(new Application(canvas, page, messages, client, answers, token));
  } catch (thrown) {
    if (!(thrown instanceof NoWebGL2Error)) throw thrown;
    messages.noWebGL2();
  }
}
