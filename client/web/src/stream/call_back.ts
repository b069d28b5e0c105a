// Errors of callbacks, which nobody here awaits.

/// Calls back. What that throws is told as an error of the page (console, "error" event), and goes no further.
export function callBack(callback: () => void): void {
  try {
    callback();
  } catch (thrown) {
    if (typeof globalThis.reportError === "function") globalThis.reportError(thrown);
    else console.error(thrown);
  }
}
