// What the browser does for the page: the whole screen, and the clipboard.

/// Shows the page on the whole screen, or ends that. Rejects where the browser does not let it.
export async function toggleFullScreen(): Promise<void> {
  if (document.fullscreenElement === null) await document.documentElement.requestFullscreen();
  else await document.exitFullscreen();
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
