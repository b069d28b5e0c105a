import { afterEach, beforeEach, describe, expect, test, vi } from "vitest";
import type { PointStore } from "../../../../../client/web/src/stream/point_store";
import { findDiscEnds } from "../../../../../client/web/src/view/discs/disc_ends";
import type { EndsFinder, FoundEnds } from "../../../../../client/web/src/view/discs/ends_finder";
import { StoreEnds } from "../../../../../client/web/src/view/discs/store_ends";

const all = { all: true, ranges: [] };

/// Two discs at a crease, and one apart, in slots 0, 1 and 2.
function makeStore(): PointStore {
  return {
    origin: [0, 0, 0],
    count: 3,
    slots: 3,
    positions: Float32Array.from([-0.05, 0, 0, 0.1, 0, 0, -0.05, 0.1, 5, 0, 0, 0.1, 0, 0, 0, 0]),
    normals: Int8Array.from([0, 0, 127, 0, 127, 0, 0, 0, 0, 0, 127, 0, 0, 0, 0, 0]),
    colours: null,
    curvatures: null,
    ranks: null,
    directions: null,
    scalars: [],
    creaseDegrees: 40,
    isSurface: true,
    takeChanges: () => ({ all: false, ranges: [] }),
  };
}

/// Answers when it is told to.
class FakeFinder implements EndsFinder {
  readonly requests: { request: Parameters<EndsFinder["find"]>[0]; answer: (found: FoundEnds | null) => void }[] = [];

  find(request: Parameters<EndsFinder["find"]>[0]): Promise<FoundEnds | null> {
    return new Promise((answer) => this.requests.push({ request, answer }));
  }

  async answer(): Promise<void> {
    const { request, answer } = this.requests.at(-1)!;
    const { positions, normals, scale, creaseDegrees } = request;
    answer({ ends: findDiscEnds(positions, normals, positions.length / 4, scale, creaseDegrees), positions });
    await vi.advanceTimersByTimeAsync(0);
  }
}

describe("the ends of a store's discs", () => {
  let store: PointStore;
  let finder: FakeFinder;
  let ends: StoreEnds;
  const onFound = vi.fn();
  const hasEnd = (slot: number): boolean => ends.planes?.subarray(8 * slot, 8 * slot + 8).some((x) => x !== 0) ?? false;
  const withEnds = (): number[] => [0, 1, 2].filter(hasEnd);

  beforeEach(() => {
    vi.useFakeTimers();
    onFound.mockClear();
    store = makeStore();
    finder = new FakeFinder();
    ends = new StoreEnds(store, finder, onFound);
    ends.refresh(all, 1);
  });
  afterEach(() => void vi.useRealTimers());

  test("are there once they are found", async () => {
    expect(ends.planes).toBeNull();
    await finder.answer();
    expect(onFound).toHaveBeenCalledTimes(1);
    expect(ends.planes?.length).toBe(32);
    expect(withEnds()).toEqual([0, 1]);
  });

  test("go with their points, and come for others", async () => {
    await finder.answer();
    ends.takeChanges("planes");
    store.positions.set([-0.04, 0, 0, 0.1], 0);
    ends.refresh({ all: false, ranges: [0, 3] }, 1);
    expect(withEnds()).toEqual([1]);
    expect(ends.takeChanges("planes")).toEqual([0, 3]);
    await vi.runAllTimersAsync();
    expect(finder.requests.length).toBe(2);
    await finder.answer();
    expect(withEnds()).toEqual([0, 1]);
    expect(onFound).toHaveBeenCalledTimes(2);
  });

  test("are not taken for points that have changed meanwhile", async () => {
    store.positions.set([7, 0, 0, 0.1], 0);
    ends.refresh({ all: false, ranges: [0, 3] }, 1);
    expect(finder.requests.length).toBe(1);
    await finder.answer();
    expect(withEnds()).toEqual([1]);
    await vi.runAllTimersAsync();
    await finder.answer();
    expect(finder.requests.length).toBe(2);
    expect(ends.planes).toBeNull();
  });

  test("stay where a store has the same points again, and are the same", async () => {
    await finder.answer();
    const { planes } = ends;
    ends.refresh(all, 1);
    expect(withEnds()).toEqual([0, 1]);
    await vi.runAllTimersAsync();
    await finder.answer();
    expect(onFound).toHaveBeenCalledTimes(1);
    expect(ends.planes).toBe(planes);
  });

  test("are found again for other radii, and for nothing else", async () => {
    await finder.answer();
    await vi.runAllTimersAsync();
    ends.refresh({ all: false, ranges: [] }, 1);
    expect(finder.requests.length).toBe(1);
    ends.refresh({ all: false, ranges: [] }, 2);
    expect(finder.requests.map(({ request }) => request.scale)).toEqual([1, 2]);
  });

  test("are there with the bends of all points that have not changed meanwhile", async () => {
    expect(ends.bends).toBeNull();
    store.positions.set([7, 0, 0, 0.1], 0);
    await finder.answer();
    const bends = ends.bends!;
    const known = (slot: number): boolean => bends[8 * slot]! > 0;
    expect(bends.length).toBe(32);
    expect([0, 1, 2, 3].map(known)).toEqual([false, true, true, false]);
    store.positions.set([-0.05, 3, 0, 0.1], 8);
    ends.takeChanges("bends");
    ends.refresh({ all: false, ranges: [2, 3] }, 1);
    expect([0, 1, 2, 3].map(known)).toEqual([false, true, false, false]);
    expect(ends.takeChanges("bends")).toEqual([0, 3]);
  });

  test("can be had at once", async () => {
    ends.complete();
    expect(withEnds()).toEqual([0, 1]);
    await finder.answer();
    expect(onFound).not.toHaveBeenCalled();
  });

  test("are searched again after a pause, and no more after a failure", async () => {
    ends.pause();
    await finder.answer();
    expect(ends.planes).toBeNull();
    ends.refresh({ all: false, ranges: [] }, 1);
    expect(finder.requests.length).toBe(2);
    finder.requests.at(-1)!.answer(null);
    await vi.runAllTimersAsync();
    ends.refresh(all, 1);
    await vi.runAllTimersAsync();
    expect(finder.requests.length).toBe(2);
  });
});
