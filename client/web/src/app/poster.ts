// SPDX-License-Identifier: Apache-2.0
// A picture that the server draws, to look at until the page can draw itself: over a slow line its larger part takes seconds to come.

interface Size {
  width: number;
  height: number;
}

const mostPixels = 120_000; // of the poster: some 6 kilobytes, which a server draws in a moment
const quickLine = 40; // ms that a page takes at most over a line that is no hindrance
const longestWait = 1500; // ms that the larger part of the page waits for the poster

/// What the server draws of what an address can say; of anything else it makes no picture like the page's own.
const drawn: Readonly<Record<string, readonly string[]>> = {
  mode: ["splats", "mesh"],
  colouring: ["colour", "shading"],
  section: ["none"],
  split: ["0"],
  projection: ["perspective"],
};

/// Whether the page begins before a dark background. `prefersDark`: what the browser says.
export function beginsDark(hash: string, prefersDark: boolean): boolean {
  const background = parameters(hash).get("background");
  return background === "dark" || (prefersDark && background !== "light");
}

/// Returns what to ask the server for: the picture with which a page of this address begins, of the form of its canvas. Null where the
/// server cannot draw it.
export function posterQuery(hash: string, canvas: Size, isDark: boolean): string | null {
  const given = parameters(hash);
  if (!(canvas.width > 0 && canvas.height > 0)) return null;
  if (Object.entries(drawn).some(([name, values]) => given.has(name) && !values.includes(given.get(name)!))) return null;
  const session = given.get("session");
  const camera = session === null ? null : given.get("camera"); // the page takes none without a session either
  if (camera === null ? given.get("up") === "z" : !/^[-+.e\d]+(,[-+.e\d]+){9}$/.test(camera)) return null;
  const shrinking = Math.min(1, Math.sqrt(mostPixels / (canvas.width * canvas.height)));
  const pixels = (length: number): number => Math.max(1, Math.round(length * shrinking));
  return [
    `width=${pixels(canvas.width)}&height=${pixels(canvas.height)}`,
    ...(session !== null ? [`key=${encodeURIComponent(session.slice(0, 16))}&session=${encodeURIComponent(session)}`] : []),
    ...(camera !== null ? [`camera=${camera}`] : []),
    ...(isDark ? ["dark=1"] : []),
    ...(given.get("colouring") === "shading" ? ["plain=1"] : []),
  ].join("&");
}

/// Whether a page came so fast that the rest will be there soon: a poster would take the server's time from it. `page`: the browser's entry
/// of it, in which a page that is still coming has no end; `now`: ms, on the same clock.
export function isQuickLine(
  page: Pick<PerformanceResourceTiming, "requestStart" | "responseEnd"> | undefined,
  now: number,
): boolean {
  return page === undefined || (page.responseEnd || now) - page.requestStart < quickLine;
}

/// The poster of a page, in front of its canvas until hide().
export class Poster {
  private readonly image = document.createElement("img");
  private isHidden = false;

  /// Asks for it. `token`: that of the page, if it has one.
  constructor(
    private readonly canvas: HTMLCanvasElement,
    token: string | undefined,
  ) {
    const isDark = beginsDark(location.hash, matchMedia("(prefers-color-scheme: dark)").matches);
    document.documentElement.dataset.theme = isDark ? "dark" : "light";
    const query = posterQuery(location.hash, { width: canvas.clientWidth, height: canvas.clientHeight }, isDark);
    const page = performance.getEntriesByType("navigation")[0] as PerformanceNavigationTiming | undefined;
    const isWanted = query !== null && !isQuickLine(page, performance.now());
    this.coming = isWanted ? this.load(query, token) : Promise.resolve();
  }

  /// Resolves once the poster is on its way, or will not come.
  readonly coming: Promise<void>;

  /// Resolves when the larger part of the page may come without delaying the poster.
  async passed(): Promise<void> {
    await Promise.race([this.coming, new Promise((done) => setTimeout(done, longestWait))]);
  }

  /// Takes it away: the page has something better to show, or nothing.
  hide(): void {
    if (this.isHidden) return;
    this.isHidden = true;
    this.image.remove();
    URL.revokeObjectURL(this.image.src);
  }

  private async load(query: string, token: string | undefined): Promise<void> {
    const headers = { "Curvecast-Page": "1", ...(token !== undefined && { Authorization: `Bearer ${token}` }) };
    try {
      const response = await fetch(`v1/poster?${query}`, { headers });
      if (response.status === 200 && response.headers.get("Content-Type") === "image/jpeg") void this.show(response.blob());
    } catch {
      // There is no poster.
    }
  }

  private async show(coming: Promise<Blob>): Promise<void> {
    const { image } = this;
    try {
      image.src = URL.createObjectURL(await coming);
      image.className = "poster";
      image.alt = "A picture of the surface, until its points are here";
      await image.decode();
      if (this.isHidden) URL.revokeObjectURL(image.src);
      else this.canvas.after(image);
    } catch {
      // There is no poster.
    }
  }
}

const parameters = (hash: string): URLSearchParams => new URLSearchParams(hash.replace(/^#/, ""));
