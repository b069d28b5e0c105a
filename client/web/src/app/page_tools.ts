// SPDX-License-Identifier: Apache-2.0
// What the browser does for the page: the whole screen, and the clipboard.

import { asCurvecastError } from "../stream";
import type { Messages } from "./messages";

/// Shows the page on the whole screen, or ends that. Says so where the browser does not let it.
export async function toggleFullScreen(messages: Messages): Promise<void> {
  try {
    if (document.fullscreenElement === null) await document.documentElement.requestFullscreen();
    else await document.exitFullscreen();
  } catch (thrown) {
    messages.failure("The browser does not give the whole screen", asCurvecastError(thrown));
  }
}

/// Copies a text for the user, or shows it to be copied where the browser keeps its clipboard from the page: on addresses without TLS.
/// Returns whether it was copied.
export async function copyText(text: string, what: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    prompt(what, text);
    return false;
  }
}
