import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";

import { ViewPacer } from "../../../../client/web/src/app/view_pacer";

let asked = 0;
let isDrawing = false;
let frames: (() => void)[] = [];

/// The browser draws the next picture.
function nextFrame(): void {
  const callbacks = frames;
  frames = [];
  for (const callback of callbacks) callback();
}

function makePacer(): ViewPacer {
  return new ViewPacer(
    () => ++asked,
    () => isDrawing,
  );
}

beforeEach(() => {
  asked = 0;
  isDrawing = false;
  frames = [];
  vi.useFakeTimers();
  vi.stubGlobal("requestAnimationFrame", (callback: () => void) => frames.push(callback));
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

describe("a view", () => {
  it("is asked for at once, and once a picture", () => {
    const pacer = makePacer();
    for (let i = 0; i < 10; ++i) pacer.request();
    expect(asked).toBe(1);
    nextFrame();
    expect(asked).toBe(2);
    nextFrame();
    nextFrame();
    expect(asked).toBe(2);
  });

  it("waits until the processor has drawn", () => {
    const pacer = makePacer();
    isDrawing = true;
    pacer.request();
    vi.advanceTimersByTime(300);
    expect(asked).toBe(0);
    isDrawing = false;
    pacer.drawn();
    expect(asked).toBe(1);
    vi.advanceTimersByTime(5000);
    nextFrame();
    pacer.drawn();
    expect(asked).toBe(1);
  });

  it("is asked for, too, where drawing does not end", () => {
    const pacer = makePacer();
    isDrawing = true;
    pacer.request();
    for (let i = 0; i < 100; ++i) {
      vi.advanceTimersByTime(100);
      nextFrame();
      pacer.request(); // the camera goes on moving
    }
    expect(asked).toBeGreaterThanOrEqual(8);
    expect(asked).toBeLessThanOrEqual(10);
  });
});
