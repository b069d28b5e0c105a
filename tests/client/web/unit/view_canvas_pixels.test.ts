import { afterEach, beforeEach, expect, test, vi } from "vitest";

import { CanvasPixels } from "../../../../client/web/src/view/canvas_pixels";

const canvas = { clientWidth: 641, clientHeight: 300 } as HTMLCanvasElement;
let screen = { devicePixelRatio: 1 };
let resize: ((entries: unknown[]) => void) | null = null;
let ratioChanged: (() => void)[] = [];
let changes = 0;

const make = (): CanvasPixels => new CanvasPixels(canvas, () => ++changes);

beforeEach(() => {
  screen = { devicePixelRatio: 1 };
  ratioChanged = [];
  changes = 0;
  vi.stubGlobal("window", screen);
  vi.stubGlobal("matchMedia", () => ({ addEventListener: (_type: string, run: () => void) => ratioChanged.push(run) }));
  vi.stubGlobal(
    "ResizeObserver",
    class {
      constructor(callback: (entries: unknown[]) => void) {
        resize = callback;
      }
      observe(): void {}
      disconnect(): void {}
    },
  );
});
afterEach(() => vi.unstubAllGlobals());

test("a canvas has the pixels of the screen, up to the bound", () => {
  screen.devicePixelRatio = 2;
  const pixels = make();
  expect(pixels.size(pixels.ratio(1), 1)).toEqual({ width: 1282, height: 600 });
  screen.devicePixelRatio = 3;
  expect(pixels.ratio(1)).toBe(2);
  pixels.maxRatio = 4;
  expect(pixels.size(pixels.ratio(1), 1)).toEqual({ width: 1923, height: 900 });
  pixels.maxRatio = 1;
  expect(pixels.size(pixels.ratio(0.5), 1)).toEqual({ width: 321, height: 150 });
});

test("a zoomed page is noticed, once and again, though its canvas is as large as before", () => {
  const pixels = make();
  for (const ratio of [1.25, 2]) {
    screen.devicePixelRatio = ratio;
    ratioChanged.at(-1)!();
    expect(pixels.ratio(1)).toBe(ratio);
  }
  expect(changes).toBe(2);
  expect(ratioChanged.length).toBe(3);
});

test("what the browser says of a canvas that begins within a pixel is taken exactly, for the ratio that it says it of", () => {
  screen.devicePixelRatio = 1.5;
  const pixels = make();
  resize!([{ devicePixelContentBoxSize: [{ inlineSize: 962, blockSize: 451 }] }]);
  expect(changes).toBe(1);
  expect(pixels.size(1.5, 1)).toEqual({ width: 962, height: 451 });
  expect(pixels.size(1.5, 2)).toEqual({ width: 481, height: 451 });
  expect(pixels.size(0.75, 1)).toEqual({ width: 481, height: 225 });
  screen.devicePixelRatio = 2;
  expect(pixels.size(2, 1)).toEqual({ width: 1282, height: 600 });
  resize!([{ devicePixelContentBoxSize: [{ inlineSize: 641, blockSize: 300 }] }]); // of an emulated device
  expect(pixels.size(2, 1)).toEqual({ width: 1282, height: 600 });
});

test("a browser that says nothing exact gets its CSS size", () => {
  const pixels = make();
  resize!([{}]);
  expect(pixels.size(1, 1)).toEqual({ width: 641, height: 300 });
  expect(pixels.size(1, 2)).toEqual({ width: 321, height: 300 });
});
