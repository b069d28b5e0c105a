import { describe, expect, it } from "vitest";

import { plyOf } from "../../../../client/web/src/app/export_ply";
import { StreamedPoints } from "../../../../client/web/src/stream/point_store";

function store(colours: Uint8Array | null): StreamedPoints {
  const points = new StreamedPoints();
  points.replace([
    {
      count: 2,
      origin: [10, 20, 30],
      places: Float32Array.of(1, 2, 3, 0.5, 4, 5, 6, 0.25),
      normals: Int8Array.of(127, 0, 0, 0, 0, -127, 0, 0),
      colours,
      curvatures: null,
      ranks: null,
    },
  ]);
  return points;
}

describe("a PLY file", () => {
  it("holds places in the mesh's frame, normals and radii", async () => {
    const bytes = new Uint8Array(await plyOf(store(null)).arrayBuffer());
    const header = new TextDecoder().decode(bytes).split("end_header\n")[0]! + "end_header\n";
    expect(header).toContain("format binary_little_endian 1.0\n");
    expect(header).toContain("element vertex 2\n");
    expect(header).not.toContain("red");
    const floats = new Float32Array(bytes.slice(header.length).buffer);
    expect([...floats]).toEqual([11, 22, 33, 1, 0, 0, 0.5, 14, 25, 36, 0, -1, 0, 0.25]);
  });

  it("holds colours where there are any", async () => {
    const bytes = new Uint8Array(await plyOf(store(Uint8Array.of(1, 2, 3, 255, 4, 5, 6, 255))).arrayBuffer());
    expect(new TextDecoder().decode(bytes)).toContain("property uchar blue\n");
    expect([...bytes.subarray(-3)]).toEqual([4, 5, 6]);
    expect([...bytes.subarray(-34, -31)]).toEqual([1, 2, 3]);
  });
});
