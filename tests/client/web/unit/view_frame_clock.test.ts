import { afterEach, beforeEach, expect, test, vi } from "vitest";

import { FrameClock } from "../../../../client/web/src/view/frame_clock";

let frameTime = 16; // ms

beforeEach(() => {
  vi.useFakeTimers({ toFake: ["performance", "setTimeout", "clearTimeout"] });
  vi.stubGlobal("requestAnimationFrame", (draw: (now: number) => void) => setTimeout(() => draw(performance.now()), frameTime));
  vi.stubGlobal("cancelAnimationFrame", (timer: number) => clearTimeout(timer));
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

/// Moves for so many frames, each of which takes `milliseconds`; the scales they are drawn at.
function move(clock: FrameClock, scales: number[], frames: number, milliseconds: number): number[] {
  frameTime = milliseconds;
  scales.length = 0;
  for (let i = 0; i < frames; ++i) {
    clock.invalidate(true);
    vi.advanceTimersByTime(milliseconds);
  }
  return [...scales];
}

function makeClock(): { clock: FrameClock; scales: number[] } {
  const scales: number[] = [];
  return { clock: new FrameClock((_now, scale) => (scales.push(scale), false), false), scales };
}

test("the frames of a second are those that were drawn, also while the picture becomes coarser", () => {
  const { clock, scales } = makeClock();
  expect(clock.framesPerSecond).toBe(0);
  const drawn = move(clock, scales, 30, 100);
  expect(drawn.at(-1)!).toBeLessThan(0.5);
  expect(clock.framesPerSecond).toBeCloseTo(10, 6);
  move(clock, scales, 60, 20);
  expect(clock.framesPerSecond).toBeCloseTo(50, 2);
});

test("there are none once nothing has moved for a second, and the pause does not count", () => {
  const { clock, scales } = makeClock();
  move(clock, scales, 10, 20);
  expect(clock.framesPerSecond).toBeCloseTo(50, 6);
  vi.advanceTimersByTime(900);
  expect(clock.framesPerSecond).toBeCloseTo(50, 6);
  vi.advanceTimersByTime(200);
  expect(clock.framesPerSecond).toBe(0);
  move(clock, scales, 2, 20);
  expect(clock.framesPerSecond).toBeCloseTo(50, 6);
});

test("a frame after a rest is no slow one", () => {
  const { clock, scales } = makeClock();
  for (let i = 0; i < 10; ++i) {
    move(clock, scales, 2, 16);
    vi.advanceTimersByTime(700);
  }
  expect(scales.at(-1)).toBe(1);
});
