import { describe, expect, it } from "vitest";

import { beginsDark, isQuickLine, posterQuery } from "../../../../../client/web/src/app/poster";
import { defaultSettings, type Settings } from "../../../../../client/web/src/app/settings";
import { writeState } from "../../../../../client/web/src/app/url_state";
import type { CameraState } from "../../../../../client/web/src/view/types";

const canvas = { width: 400, height: 300 };
const defaults = defaultSettings(false, "light");
const camera: CameraState = { eye: [1.5, -2, 3e-9], target: [0, 0.25, 0], up: [0, 1, 0], fov: 30 };

const queryOf = (settings: Partial<Settings>, at: CameraState | null = camera): URLSearchParams | null => {
  const query = posterQuery(
    writeState("0123456789abcdef0123456789abcdef", at, { ...defaults, ...settings }, defaults),
    canvas,
    false,
  );
  return query === null ? null : new URLSearchParams(query);
};

describe("the question for a poster", () => {
  it("has the form of the canvas, and few pixels", () => {
    expect(posterQuery("", canvas, false)).toBe("width=400&height=300");
    const large = new URLSearchParams(posterQuery("", { width: 3840, height: 2160 }, false)!);
    const [width, height] = [Number(large.get("width")), Number(large.get("height"))];
    expect(width * height).toBeLessThan(121_000);
    expect(width / height).toBeCloseTo(3840 / 2160, 2);
    expect(posterQuery("", { width: 100_000, height: 1 }, false)).toContain("height=1");
    expect(posterQuery("", { width: 0, height: 400 }, false)).toBeNull();
  });

  it("has the session and the view of the address", () => {
    const query = queryOf({})!;
    expect(query.get("session")).toBe("0123456789abcdef0123456789abcdef");
    expect(query.get("key")).toBe("0123456789abcdef");
    expect(query.get("camera")).toBe("1.5,-2,3e-9,0,0.25,0,0,1,0,30");
    expect(queryOf({}, null)!.has("camera")).toBe(false);
    expect(posterQuery("#camera=1,2,3,0,0,0,0,1,0,30", canvas, false)).toBe("width=400&height=300");
    expect(posterQuery("#session=a%26b", canvas, false)).toContain("&session=a%26b");
  });

  it("says whether the picture is dark, and of clay", () => {
    expect(queryOf({})!.has("plain")).toBe(false);
    expect(queryOf({ colouring: "shading" })!.get("plain")).toBe("1");
    expect(posterQuery("", canvas, true)).toContain("&dark=1");
  });

  it("is not asked where the server would draw something else", () => {
    expect(queryOf({ mode: "mesh" })).not.toBeNull();
    expect(queryOf({ mode: "dots" })).toBeNull();
    expect(queryOf({ colouring: "normal" })).toBeNull();
    expect(queryOf({ section: "x" })).toBeNull();
    expect(queryOf({ split: true })).toBeNull();
    expect(queryOf({ projection: "orthographic" })).toBeNull();
    expect(queryOf({ up: "z" }, null)).toBeNull();
    expect(queryOf({ up: "z" }, { ...camera, up: [0, 0, 1] })).not.toBeNull();
    expect(posterQuery("#session=a&camera=1,2,3", canvas, false)).toBeNull();
    expect(posterQuery("#session=a&camera=1,2,3,4,5,6,7,8,9,x", canvas, false)).toBeNull();
  });
});

describe("the first background", () => {
  it("is that of the address, else the one that the browser prefers", () => {
    expect(beginsDark("", false)).toBe(false);
    expect(beginsDark("", true)).toBe(true);
    expect(beginsDark("#background=dark", false)).toBe(true);
    expect(beginsDark("#background=light", true)).toBe(false);
    expect(beginsDark("#background=other", true)).toBe(true);
  });
});

describe("a quick line", () => {
  it("is one over which the page takes a moment", () => {
    expect(isQuickLine({ requestStart: 5, responseEnd: 11 }, 100)).toBe(true);
    expect(isQuickLine({ requestStart: 5, responseEnd: 50 }, 100)).toBe(false);
    expect(isQuickLine({ requestStart: 205, responseEnd: 420 }, 500)).toBe(false);
  });

  it("may be known before the page is whole", () => {
    expect(isQuickLine({ requestStart: 5, responseEnd: 0 }, 11)).toBe(true);
    expect(isQuickLine({ requestStart: 5, responseEnd: 0 }, 300)).toBe(false);
  });

  it("is assumed where nothing is known", () => expect(isQuickLine(undefined, 500)).toBe(true));
});
