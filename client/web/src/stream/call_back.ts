// SPDX-License-Identifier: Apache-2.0
// Keeps errors of a page's callbacks away from the client that calls them.

/// Calls back. Reports what the callback throws as an error of the page (console, "error" event).
export function callBack(callback: () => void): void {
  try {
    callback();
  } catch (thrown) {
    if (typeof globalThis.reportError === "function") globalThis.reportError(thrown);
    else console.error(thrown);
  }
}
