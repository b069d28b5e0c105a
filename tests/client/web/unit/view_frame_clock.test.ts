import { afterEach, beforeEach, describe, expect, test, vi } from "vitest";

import { FrameClock, type Detail } from "../../../../client/web/src/view/frame_clock";

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
  const draw = (_now: number, { scale }: Detail) => (scales.push(scale), { moves: false, points: 0, isWhole: true });
  return { clock: new FrameClock(draw, false), scales };
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

describe("a machine that draws slowly", () => {
  const all = 200_000; // points
  const each = 0.01; // ms a point

  /// Draws as the processor does, which takes its time for each point.
  function makeSlow(): { clock: FrameClock; frames: { points: number; scale: number }[] } {
    const frames: { points: number; scale: number }[] = [];
    const clock = new FrameClock((_now, { scale, mostPoints }) => {
      const points = Math.min(all, mostPoints);
      frames.push({ points, scale });
      setTimeout(() => clock.drawn(), each * points);
      return { moves: false, points, isWhole: points === all };
    }, true);
    return { clock, frames };
  }

  test("draws few points while something moves, and all of them once it is still", () => {
    const { clock, frames } = makeSlow();
    for (let i = 0; i < 30; ++i) {
      clock.invalidate(true);
      vi.advanceTimersByTime(frameTime + each * Math.min(all, frames.at(-1)?.points ?? 0));
    }
    expect(Math.max(...frames.map(({ points }) => points))).toBeLessThan(all / 8);
    expect(each * frames.at(-1)!.points).toBeLessThan(60); // ms
    vi.advanceTimersByTime(1000);
    expect(frames.at(-1)).toEqual({ points: all, scale: 1 });
  });

  test("tells how long a fine frame took, once", () => {
    const { clock, frames } = makeSlow();
    clock.invalidate(false);
    vi.advanceTimersByTime(frameTime);
    expect(frames).toEqual([{ points: all, scale: 1 }]);
    expect(clock.drawn()).toMatchObject({ points: all, isFine: true });
    expect(clock.drawn()).toBeNull();
  });

  test("with a graphics card gives up pixels first, then points, and takes them back", () => {
    const frames: Detail[] = [];
    let perPoint = 0.0006; // ms
    let points = all;
    const clock = new FrameClock((_now, detail) => {
      frames.push(detail);
      points = Math.min(all, detail.mostPoints);
      return { moves: false, points, isWhole: points === all };
    }, false);
    const draw = (count: number): void => {
      for (let i = 0; i < count; ++i) {
        frameTime = 8 + perPoint * points * (frames.at(-1)?.scale ?? 1);
        clock.invalidate(true);
        vi.advanceTimersByTime(frameTime);
        clock.drawn();
      }
    };
    draw(60);
    expect(frames.find(({ mostPoints }) => mostPoints < all)!.scale).toBeLessThanOrEqual(0.5);
    expect(frameTime).toBeLessThan(60);
    perPoint = 1e-5;
    draw(400);
    expect(frames.at(-1)!.mostPoints).toBeGreaterThan(all);
    expect(frames.at(-1)!.scale).toBe(1);
  });
});
