// SPDX-License-Identifier: Apache-2.0
// Starts the application once the page is loaded.

import "./panel.css";
import "./style.css";
import "./messages.css";

import { NoWebGL2Error } from "../view";
import { Application } from "./app";
import type { Begun } from "./begin";
import { handleOf } from "./handle";
import { Messages } from "./messages";

/// Opens the page.
export function open(begun: Begun): void {
  const canvas = document.querySelector("canvas")!;
  const page = document.querySelector("main")!;
  const messages = new Messages(page);
  try {
    window.curvecast = handleOf(new Application(canvas, page, messages, begun));
  } catch (thrown) {
    if (!(thrown instanceof NoWebGL2Error)) throw thrown;
    messages.noWebGL2();
  }
}
