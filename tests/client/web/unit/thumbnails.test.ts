import { describe, expect, it } from "vitest";

import { Thumbnails } from "../../../../client/web/src/app/thumbnails";

function storage(text: string | null = null) {
  return { text, getItem: () => text, setItem: (_: string, value: string) => void (text = value) };
}

const picture = (text: string): string => `data:image/jpeg;base64,${text}`;

describe("thumbnails", () => {
  it("are kept for the next page of the tab, the newest ones", () => {
    const kept = storage();
    const thumbnails = new Thumbnails(kept);
    for (let i = 0; i < 30; ++i) thumbnails.keep(`session${i}`, picture(String(i)));
    thumbnails.keep("session7", picture("again"));
    thumbnails.keep("session8", null);
    for (const each of [thumbnails, new Thumbnails(kept)]) {
      expect(each.of("session7")).toBe(picture("again"));
      expect(each.of("session29")).toBe(picture("29"));
      expect(each.of("session5")).toBeNull();
      expect(each.of("session8")).toBe(picture("8"));
    }
  });

  it("do without a storage, without room and with nonsense", () => {
    const full = {
      getItem: () => "{]",
      setItem: () => {
        throw new Error("full");
      },
    };
    for (const store of [null, full, storage('{"a":1}'), storage('[["a"],["b","https://elsewhere.example/x.png"],3,null]')]) {
      const thumbnails = new Thumbnails(store);
      expect(thumbnails.of("b")).toBeNull();
      thumbnails.keep("a", picture("x"));
      expect(thumbnails.of("a")).toBe(picture("x"));
    }
  });
});
