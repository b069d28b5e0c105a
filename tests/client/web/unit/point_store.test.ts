import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";

import { PointEditsSchema } from "../../../../client/web/src/gen/curvecast/v1/curvecast_pb";
import type { DecodedPoints } from "../../../../client/web/src/stream/decoded_points";
import { StreamedPoints } from "../../../../client/web/src/stream/point_store";

interface Point {
  id: number;
  rung: number;
}

const largest = 2;

/// A small generator: the same numbers in every run.
function generator(seed: number): (below: number) => number {
  let state = seed;
  return (below) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor((state / 2 ** 32) * below);
  };
}

function radius(rung: number): number {
  return Math.fround(largest * 2 ** (-rung / 2));
}

function decoded(points: readonly Point[], origin: [number, number, number] = [5, 6, 7]): DecodedPoints {
  return {
    count: points.length,
    origin,
    positions: Float32Array.from(points.flatMap(({ id, rung }) => [id, id + 0.5, -id, radius(rung)])),
    normals: Int8Array.from(points.flatMap(({ id }) => [id % 100, 1, 2, 0])),
    colours: Uint8Array.from(points.flatMap(({ id }) => [id % 256, 1, 2, 255])),
    curvatures: Float32Array.from(points.flatMap(({ id }) => [id, 2 * id])),
    ranks: Uint32Array.from(points.map(({ id }) => id)),
    directions: Float32Array.from(points.flatMap(({ id }) => [id, 0, -id])),
    scalars: [
      { name: "heat", values: Float32Array.from(points.map(({ id }) => 3 * id)) },
      { name: "age", values: Float32Array.from(points.map(({ id }) => (id % 2 === 0 ? NaN : id))) },
    ],
  };
}

function steps(indices: readonly number[]): number[] {
  return indices.map((index, i) => (i === 0 ? index : index - indices[i - 1]!));
}

function isSame(a: Float32Array, b: Float32Array): boolean {
  return a.length === b.length && a.every((value, i) => value === b[i]);
}

function listed(store: StreamedPoints): Point[] {
  return Array.from(store.order(), (slot) => ({
    id: store.ranks![slot]!,
    rung: Math.round(2 * Math.log2(largest / store.positions[4 * slot + 3]!)),
  }));
}

function expectSame(store: StreamedPoints, list: readonly Point[]): void {
  expect(store.count).toBe(list.length);
  expect(listed(store)).toEqual(list);
  const { positions, normals, colours, curvatures, ranks, directions, scalars } = store;
  expect(scalars.map(({ name }) => name)).toEqual(list.length > 0 ? ["heat", "age"] : []);
  const wrong = store.order().filter((slot) => {
    const id = ranks![slot]!;
    return (
      !isSame(positions.subarray(4 * slot, 4 * slot + 3), Float32Array.of(id, id + 0.5, -id)) ||
      normals[4 * slot] !== id % 100 ||
      colours![4 * slot] !== id % 256 ||
      curvatures![2 * slot + 1] !== 2 * id ||
      directions![3 * slot + 2] !== -id ||
      scalars[0]!.values[slot] !== 3 * id ||
      !Object.is(scalars[1]!.values[slot], id % 2 === 0 ? NaN : id)
    );
  });
  expect(wrong.length).toBe(0);
  let used = 0;
  for (let slot = 0; slot < store.slots; ++slot) used += store.positions[4 * slot + 3]! > 0 ? 1 : 0;
  expect(used).toBe(list.length); // free slots have radius 0
}

describe("a store", () => {
  it("follows random edits as a plain list does, and names every slot that changes", () => {
    const random = generator(3);
    const store = new StreamedPoints();
    let list: Point[] = Array.from({ length: 500 }, (_, id) => ({ id, rung: 10 }));
    let nextId = 500;
    store.replace([decoded(list.slice(0, 200)), decoded(list.slice(200))]);
    let copy = new Float32Array(0); // as a graphics card would have it
    for (let round = 0; round < 300; ++round) {
      const changes = store.takeChanges();
      if (changes.all) copy = store.positions.slice();
      for (let r = 0; r < changes.ranges.length; r += 2) {
        copy.set(store.positions.subarray(4 * changes.ranges[r]!, 4 * changes.ranges[r + 1]!), 4 * changes.ranges[r]!);
      }
      expect(isSame(copy.subarray(0, 4 * store.slots), store.positions.subarray(0, 4 * store.slots))).toBe(true);

      const removed = list.map((_, i) => i).filter(() => random(round % 10 === 9 ? 2 : 20) === 0);
      const kept = list.filter((_, i) => !removed.includes(i));
      const size = kept.length + random(40);
      const gaps = new Set<number>();
      while (gaps.size < size - kept.length) gaps.add(random(size));
      const added = [...gaps].sort((a, b) => a - b);
      const fresh = added.map(() => ({ id: nextId++, rung: 4 + random(8) }));
      list = [];
      for (let i = 0, k = 0, f = 0; i < size; ++i) list.push({ ...(gaps.has(i) ? fresh[f++]! : kept[k++]!) });
      const resized: number[] = [];
      let last = 0;
      for (let i = 0; i < size; ++i) {
        for (let times = random(30) === 0 ? 1 + random(2) : 0; times > 0; --times) {
          const smaller = random(2);
          resized.push(2 * (i - last) + smaller);
          last = i;
          list[i]!.rung = Math.max(0, list[i]!.rung + (smaller === 1 ? 1 : -1));
        }
      }
      const edits = create(PointEditsSchema, { removed: steps(removed), added: steps(added), resized, radiusMax: largest });
      const half = fresh.length >> 1;
      const difference = store.edit(edits, [decoded(fresh.slice(0, half)), decoded(fresh.slice(half))], size);
      expect(difference).toEqual({ added: added.length, removed: removed.length, resized: resized.length });
      if (round % 10 === 9) expectSame(store, list);
    }
    expectSame(store, list);
  });

  it("touches only what a delta changes", () => {
    const store = new StreamedPoints();
    store.replace([decoded(Array.from({ length: 10_000 }, (_, id) => ({ id, rung: 1 })))]);
    expect(store.takeChanges().all).toBe(true);
    store.edit(create(PointEditsSchema, { removed: [5000], added: [17] }), [decoded([{ id: 10_000, rung: 1 }])], 10_000);
    const changes = store.takeChanges();
    expect(changes.all).toBe(false);
    expect(changes.ranges.length).toBe(2);
    expect(changes.ranges[0]! <= 5000 && changes.ranges[1]! > 5000 && changes.ranges[1]! - changes.ranges[0]! <= 64).toBe(true);
    expect(store.takeChanges()).toEqual({ all: false, ranges: [] });
    expect(store.order()[17]).toBe(5000);
  });

  it("gives slots back after most points have gone", () => {
    const store = new StreamedPoints();
    const list = Array.from({ length: 20_000 }, (_, id) => ({ id, rung: 1 }));
    store.replace([decoded(list)]);
    store.edit(create(PointEditsSchema, { removed: steps(list.map((_, i) => i).filter((i) => i % 4 !== 0)) }), [], 5000);
    expect(store.slots).toBe(5000);
    expectSame(
      store,
      list.filter((_, i) => i % 4 === 0),
    );
  });

  it("begins from nothing, and may end with it", () => {
    const store = new StreamedPoints();
    store.edit(
      create(PointEditsSchema, { added: [0, 1] }),
      [
        decoded([
          { id: 1, rung: 2 },
          { id: 2, rung: 2 },
        ]),
      ],
      2,
    );
    expectSame(store, [
      { id: 1, rung: 2 },
      { id: 2, rung: 2 },
    ]);
    store.edit(create(PointEditsSchema, { removed: [0, 1] }), [], 0);
    expect(store.count).toBe(0);
    store.edit(create(PointEditsSchema, { added: [0] }), [decoded([{ id: 9, rung: 2 }], [0, 0, 1])], 1);
    expect(store.origin).toEqual([0, 0, 1]);
  });

  it("refuses edits that do not fit, and stays as it was", () => {
    const store = new StreamedPoints();
    const list = [0, 1, 2, 3].map((id) => ({ id, rung: 3 }));
    store.replace([decoded(list)]);
    const one = decoded([{ id: 9, rung: 3 }]);
    const refused = (init: Parameters<typeof create<typeof PointEditsSchema>>[1], blocks: DecodedPoints[], expected: number) =>
      expect(() => store.edit(create(PointEditsSchema, init), blocks, expected)).toThrow(/bad points/);
    refused({ removed: [4] }, [], 3);
    refused({ removed: [1, 0] }, [], 2);
    refused({ removed: [0, 1, 1, 1, 1] }, [], 0);
    refused({ added: [5] }, [one], 5);
    refused({ added: [1, 1] }, [one], 5);
    refused({}, [one], 5);
    refused({ added: [0] }, [one], 6);
    refused({ resized: [8], radiusMax: 1 }, [], 4);
    refused({ resized: [0], radiusMax: 0 }, [], 4);
    refused({ resized: [0], radiusMax: NaN }, [], 4);
    refused({ added: [0] }, [{ ...one, colours: null }], 5);
    refused({ added: [0] }, [{ ...one, directions: null }], 5);
    refused({ added: [0] }, [{ ...one, scalars: one.scalars.slice(1) }], 5);
    refused({ added: [0] }, [{ ...one, scalars: [...one.scalars].reverse() }], 5);
    refused({ added: [0] }, [decoded([{ id: 9, rung: 3 }], [0, 0, 0])], 5);
    expectSame(store, list);
  });
});
