// SPDX-License-Identifier: Apache-2.0
// Small pictures of the sessions that this tab has shown, for the list.

const storageKey = "curvecast.thumbnails";
const most = 24; // the newest ones
export const thumbnailSize = { width: 128, height: 96 }; // pixels

/// Where texts are kept; null where the browser keeps nothing for pages.
export type TextStorage = Pick<Storage, "getItem" | "setItem"> | null;

/// Returns the storage of this tab.
export function tabStorage(): TextStorage {
  try {
    return window.sessionStorage;
  } catch {
    return null;
  }
}

/// Keeps pictures as data URLs, by their sessions' ids, for as long as the tab is open.
export class Thumbnails {
  private readonly urls = new Map<string, string>(); // the newest last

  constructor(private readonly storage: TextStorage) {
    for (const [id, url] of read(storage)) this.urls.set(id, url);
  }

  of(sessionId: string): string | null {
    return this.urls.get(sessionId) ?? null;
  }

  /// Keeps a picture; null: none could be made.
  keep(sessionId: string, url: string | null): void {
    if (url === null) return;
    this.urls.delete(sessionId);
    this.urls.set(sessionId, url);
    for (const id of [...this.urls.keys()].slice(0, -most)) this.urls.delete(id);
    try {
      this.storage?.setItem(storageKey, JSON.stringify([...this.urls]));
    } catch {
      // There is no room: the pictures last as long as the page.
    }
  }
}

/// Returns what is kept, without what makes no sense.
function read(storage: TextStorage): (readonly [string, string])[] {
  try {
    const kept: unknown = JSON.parse(storage?.getItem(storageKey) ?? "[]");
    if (!Array.isArray(kept)) return [];
    return kept.filter(
      (entry): entry is [string, string] =>
        Array.isArray(entry) &&
        entry.length === 2 &&
        entry.every((part) => typeof part === "string") &&
        isPicture(String(entry[1])),
    );
  } catch {
    return [];
  }
}

const isPicture = (url: string): boolean => /^data:image\/(jpeg|png);base64,/.test(url);
