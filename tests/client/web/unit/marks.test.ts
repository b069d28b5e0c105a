import { describe, expect, it } from "vitest";

import { cleanText, maxText, readMark, writeMark, type Mark } from "../../../../client/web/src/app/marks/mark";
import { defaultSettings } from "../../../../client/web/src/app/settings";
import { readState, writeState } from "../../../../client/web/src/app/url_state";

const defaults = defaultSettings(false, "light");
const marks: Mark[] = [
  { place: [1, -2.5, 3e-7], text: "the left ear, <b>bent</b>; a & b = c # d, e" },
  { place: [4_512_345.67891, 0, 0], text: "" },
  { place: [0, 0, 0], text: "größer als 5 µm 🦊" },
];

describe("annotations", () => {
  it("are kept by the address, whatever their texts are", () => {
    const hash = writeState("abc", null, { ...defaults, marks, marking: true }, defaults);
    expect(hash).not.toContain("<");
    expect(hash).not.toContain("marking");
    expect(readState(hash, defaults).settings.marks).toEqual(marks);
  });

  it("are twenty at most, of eighty characters in one line", () => {
    const many = Array.from({ length: 25 }, (_, i): Mark => ({ place: [i, 0, 0], text: "x".repeat(100) }));
    const read = readState(writeState(null, null, { ...defaults, marks: many }, defaults), defaults).settings.marks!;
    expect(read.length).toBe(20);
    expect(read.every(({ text }) => text.length === maxText)).toBe(true);
    expect(cleanText("  a\n\tb\u0000\u202e c  ")).toBe("a b c");
    expect(Array.from(cleanText("🦊".repeat(100))).length).toBe(maxText);
  });

  it("are left out where they make no sense", () => {
    for (const written of ["", "1,2,3", "1,2,x,text", "1,,3,text", "1,2,Infinity,text", "text"])
      expect(readMark(written)).toBeNull();
    expect(readMark("1,2,3,")).toEqual({ place: [1, 2, 3], text: "" });
    expect(readState("#mark=1,2&mark=x", defaults).settings).toEqual({});
    expect(readMark(writeMark(marks[0]!, String))).toEqual(marks[0]);
  });
});
