import { readFileSync } from "node:fs";

import { fromJson } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";

import { PointEditsSchema } from "../../../../client/web/src/gen/curvecast/v1/curvecast_pb";
import type { DecodedPoints } from "../../../../client/web/src/stream/decoded_points";
import { StreamedPoints } from "../../../../client/web/src/stream/point_store";
import { pointEditsCases, type PointEditsCase, type Row } from "../../make_point_edits.mjs";

const cases = JSON.parse(readFileSync(new URL("../../point_edits.json", import.meta.url), "utf8")) as PointEditsCase[];

function decoded(rows: readonly Row[], largest: number): DecodedPoints {
  return {
    count: rows.length,
    origin: [0, 0, 0],
    positions: Float32Array.from(rows.flatMap(([id, rung]) => [id, 2 * id, 3 * id, largest * 2 ** (-rung / 2)])),
    normals: new Int8Array(4 * rows.length).fill(1),
    colours: null,
    curvatures: null,
    ranks: Uint32Array.from(rows, ([id]) => id),
    directions: null,
    scalars: [],
  };
}

function listed(store: StreamedPoints, largest: number): Row[] {
  return Array.from(store.order(), (slot): Row => {
    const [x, y, z, radius] = store.positions.subarray(4 * slot, 4 * slot + 4);
    const id = store.ranks![slot]!;
    expect([x, y, z]).toEqual([id, 2 * id, 3 * id]);
    return [id, Math.round(2 * Math.log2(largest / radius!))];
  });
}

describe("edits of a list of points", () => {
  it("are those of make_point_edits.mjs", () => {
    expect(cases).toEqual(pointEditsCases());
  });

  it.each(cases)("$name", ({ before, edits, fresh, after }) => {
    const { radiusMax } = edits;
    const largest = typeof radiusMax === "number" && radiusMax > 0 ? radiusMax : 1;
    const store = new StreamedPoints();
    store.replace([decoded(before, largest)]);
    const expected = before.length - ((edits.removed as number[] | undefined)?.length ?? 0) + fresh.length;
    const edit = () => store.edit(fromJson(PointEditsSchema, edits), [decoded(fresh, largest)], expected);
    if (after === null) expect(edit).toThrow(/bad points/);
    else edit();
    expect(listed(store, largest)).toEqual(after ?? before);
  });
});
