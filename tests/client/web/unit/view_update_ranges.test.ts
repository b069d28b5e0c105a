import { expect, test } from "vitest";
import { putRows, rowSlots } from "../../../../client/web/src/view/store_texture";
import { mergeRanges } from "../../../../client/web/src/view/update_ranges";

test("ranges that lie near each other become one, others stay apart", () => {
  expect(mergeRanges([10, 20, 30, 40, 5000, 5001], 100_000)).toEqual([10, 40, 5000, 5001]);
  expect(mergeRanges([], 100_000)).toEqual([]);
});

test("all is uploaded at once where that costs no more", () => {
  const scattered = Array.from({ length: 2000 }, (_, i) => [i * 25, i * 25 + 1]).flat();
  expect(mergeRanges(scattered, 50_000)).toBeNull();
});

test("every slot of the ranges is covered, and rectangles are whole rows or lie within one", () => {
  let state = 1;
  const random = (below: number): number => (state = (state * 48271) % 2147483647) % below;
  for (let round = 0; round < 200; ++round) {
    const slots = 20_000;
    const ranges: number[] = [];
    for (let at = random(3000); at < slots;) {
      const end = Math.min(slots, at + 1 + random(random(2) ? 20 : 6000));
      ranges.push(at, end);
      at = end + 1 + random(3000);
    }
    const merged = mergeRanges(ranges, slots) ?? [0, slots];
    const covered = new Uint8Array(slots);
    for (let i = 0; i < merged.length; i += 2) {
      putRows(merged[i]!, merged[i + 1]!, (begin, width, height) => {
        expect(height === 1 ? (begin % rowSlots) + width <= rowSlots : begin % rowSlots === 0 && width === rowSlots).toBe(true);
        for (let slot = begin; slot < begin + width * height; ++slot) ++covered[slot]!;
      });
    }
    expect(Math.max(...covered)).toBeLessThanOrEqual(1);
    for (let i = 0; i < ranges.length; i += 2) {
      for (let slot = ranges[i]!; slot < ranges[i + 1]!; ++slot)
        if (covered[slot] !== 1) expect.fail(`slot ${slot} is not covered`);
    }
  }
});
