import { describe, expect, it } from "vitest";

import { CloudStore } from "../../../../../client/web/src/cloud/cloud_store";
import { readCloud } from "../../../../../client/web/src/cloud/read_cloud";
import { fileOf, lasOf, unheard } from "./files";

const read = (name: string, data: Blob) => readCloud({ name, data }, unheard);

describe("a cloud", () => {
  it("has its places about the middle of its box, in an order of its own", async () => {
    const text = Array.from({ length: 100 }, (_, i) => `${4.5e6 + 0.001 * i} ${-i} 5 ${i} 0 0\n`).join("");
    const parts: number[] = [];
    const cloud = await readCloud({ name: "utm.XYZ", data: fileOf(text) }, (part) => parts.push(part));
    expect(cloud.count).toBe(100);
    expect(cloud.min).toEqual([4.5e6, -99, 5]);
    expect(cloud.max).toEqual([4.5e6 + 0.099, 0, 5]);
    for (let slot = 0; slot < 100; ++slot) {
      const which = cloud.colours![4 * slot]!; // its number in the file
      expect(cloud.positions[4 * slot]! + cloud.origin[0]).toBeCloseTo(4.5e6 + 0.001 * which, 6);
      expect(cloud.positions[4 * slot + 1]! + cloud.origin[1]).toBeCloseTo(-which, 4);
      expect(cloud.colours![4 * slot + 3]).toBe(255);
    }
    expect(parts.at(-1)).toBeLessThanOrEqual(1);
  });

  it("is a store of points without an outer side", async () => {
    const store = new CloudStore(await read("one.txt", fileOf("1 2 3\n")));
    expect([store.count, store.slots, store.isSurface, store.colours]).toEqual([1, 1, false, null]);
    expect([...store.origin]).toEqual([1, 2, 3]);
    expect([...store.order()]).toEqual([0]);
    expect(store.takeChanges()).toEqual({ all: true, ranges: [] });
    expect(store.takeChanges()).toEqual({ all: false, ranges: [] });
  });

  it("has a box of some size where all its points are at one place", async () => {
    const { min, max } = await read("one.csv", fileOf("1,2,3\n1,2,3\n"));
    expect(min.every((least, axis) => max[axis]! > least)).toBe(true);
  });

  it("is read by its name", async () => {
    const ply =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n";
    expect((await read("a.ply", fileOf(ply))).count).toBe(1);
    expect((await read("a.LAS", lasOf({ records: [{ place: [1, 2, 3] }] }))).count).toBe(1);
    await expect(read("a.laz", lasOf({ format: 128, records: [{ place: [1, 2, 3] }] }))).rejects.toThrow(/LAZ/);
  });

  it("is refused where there is nothing in it", async () => {
    await expect(read("a.xyz", fileOf())).rejects.toThrow("the file is empty");
    await expect(read("a.xyz", fileOf("nan nan nan\n"))).rejects.toThrow(
      "there are no points in it. 1 point without a place was left out",
    );
    const none = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    await expect(read("a.ply", fileOf(none))).rejects.toThrow("there are no points in it");
  });
});
