import { describe, expect, test } from "vitest";
import { linesOf } from "../../../../client/web/src/app/marks/draw_label";

/// Letters are a pixel wide.
const lines = (text: string, width: number): string[] => linesOf(text, width, (part) => part.length);

describe("lines of a label", () => {
  test("break between words", () => {
    expect(lines("a crack in the glaze", 8)).toEqual(["a crack", "in the", "glaze"]);
    expect(lines("short", 8)).toEqual(["short"]);
    expect(lines("", 8)).toEqual([]);
    expect(lines("   ", 2)).toEqual([]);
  });

  test("break within words that are too long, and lose no letter", () => {
    expect(lines("a floccinaucinihilipilification b", 10)).toEqual(["a", "floccinauc", "inihilipil", "ification", "b"]);
    expect(lines("abc", 0.5)).toEqual(["a", "b", "c"]);
    const text = "every letter of this text is somewhere, pneumonoultramicroscopicsilicovolcanoconiosis too";
    for (let width = 1; width < 60; ++width) {
      const found = lines(text, width);
      expect(found.join("").replaceAll(" ", "")).toBe(text.replaceAll(" ", ""));
      for (const line of found) expect(line.length).toBeLessThanOrEqual(width);
    }
  });
});
