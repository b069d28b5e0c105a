// SPDX-License-Identifier: Apache-2.0
// The token that a page shows the server. It comes with the address, and is kept for the pages of this tab.

const tokenKey = "curvecast.token";

/// The token of a page.
export class PageToken {
  private constructor(readonly value: string | undefined) {}

  /// Takes the token out of the address, or that of an earlier page in this tab.
  static take(): PageToken {
    const given = new URLSearchParams(location.hash.replace(/^#/, ""));
    const token = given.get("token");
    if (token !== null) {
      given.delete("token");
      replaceHash(given);
      store(token);
    }
    try {
      return new PageToken(token ?? sessionStorage.getItem(tokenKey) ?? undefined);
    } catch {
      return new PageToken(undefined);
    }
  }

  /// Keeps another one for the next page in this tab. Where the browser stores nothing for pages, the token is in the address until that
  /// page takes it: load it at once.
  keep(token: string): void {
    if (store(token)) return;
    const given = new URLSearchParams(location.hash.replace(/^#/, ""));
    given.set("token", token);
    replaceHash(given);
  }
}

/// Stores a token for this tab. Returns false where the browser stores nothing for pages.
function store(token: string): boolean {
  try {
    sessionStorage.setItem(tokenKey, token);
    return true;
  } catch {
    return false;
  }
}

function replaceHash(parameters: URLSearchParams): void {
  const text = parameters.toString();
  history.replaceState(null, "", location.pathname + location.search + (text === "" ? "" : `#${text}`));
}
