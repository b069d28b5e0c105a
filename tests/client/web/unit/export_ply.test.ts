import { describe, expect, it } from "vitest";

import { meshPlyOf, plyOf } from "../../../../client/web/src/app/export_ply";
import type { DecodedPoints } from "../../../../client/web/src/stream/decoded_points";
import { StreamedPoints } from "../../../../client/web/src/stream/point_store";

/// Two points.
function store(more: Partial<DecodedPoints> = {}): StreamedPoints {
  const points = new StreamedPoints();
  points.replace([
    {
      count: 2,
      origin: [0, 0, 0],
      positions: Float32Array.of(1, 2, 3, 0.5, 4, 5, 6, 0.25),
      normals: Int8Array.of(127, 0, 0, 0, 0, -127, 0, 0),
      colours: null,
      curvatures: null,
      ranks: null,
      directions: null,
      scalars: [],
      ...more,
    },
  ]);
  return points;
}

/// The lines of the header, and the data behind it.
async function parse(points: StreamedPoints, file = plyOf(points)): Promise<{ lines: string[]; data: DataView }> {
  const bytes = new Uint8Array(await file.arrayBuffer());
  const header = new TextDecoder().decode(bytes).split("end_header\n")[0]! + "end_header\n";
  return { lines: header.split("\n"), data: new DataView(bytes.slice(header.length).buffer) };
}

const properties = (lines: string[]) =>
  lines.filter((line) => line.startsWith("property")).map((line) => line.slice("property ".length));

describe("a PLY file", () => {
  it("holds positions, normals and radii", async () => {
    const { lines, data } = await parse(store());
    expect(lines).toContain("format binary_little_endian 1.0");
    expect(lines).toContain("element vertex 2");
    expect(properties(lines)).toEqual(["x", "y", "z", "nx", "ny", "nz", "radius"].map((name) => `float ${name}`));
    expect([...new Float32Array(data.buffer)]).toEqual([1, 2, 3, 1, 0, 0, 0.5, 4, 5, 6, 0, -1, 0, 0.25]);
  });

  it("holds positions in the mesh's frame as doubles where they have an origin", async () => {
    const { lines, data } = await parse(store({ origin: [4_500_000.1, 0, -2e7] }));
    expect(properties(lines).slice(0, 4)).toEqual(["double x", "double y", "double z", "float nx"]);
    expect([0, 8, 16].map((at) => data.getFloat64(40 + at, true))).toEqual([4_500_004.1, 5, -2e7 + 6]);
    expect(data.getFloat32(40 + 36, true)).toBe(0.25);
    expect(data.byteLength).toBe(80);
  });

  it("holds further columns where there are any, in the order of the command's files", async () => {
    const { lines, data } = await parse(
      store({
        colours: Uint8Array.of(1, 2, 3, 255, 4, 5, 6, 255),
        curvatures: Float32Array.of(-1, 2, -3, 4),
        ranks: Uint32Array.of(7, 4_000_000_000),
        directions: Float32Array.of(1, 0, 0, 0, 0.5, -1),
        scalars: [
          { name: "heat", values: Float32Array.of(8, NaN) },
          { name: "a b\n\u00e9", values: Float32Array.of(8, 9) },
        ],
      }),
    );
    expect(properties(lines).slice(6)).toEqual([
      "uchar red",
      "uchar green",
      "uchar blue",
      "float radius",
      "float curvature_min",
      "float curvature_max",
      "uint rank",
      "float direction_min_x",
      "float direction_min_y",
      "float direction_min_z",
      "float scalar_heat",
      "float scalar_a_b___",
    ]);
    const stride = 63;
    expect(data.byteLength).toBe(2 * stride);
    expect([24, 25, 26].map((at) => data.getUint8(stride + at))).toEqual([4, 5, 6]);
    expect([27, 31, 35].map((at) => data.getFloat32(stride + at, true))).toEqual([0.25, -3, 4]);
    expect(data.getUint32(stride + 39, true)).toBe(4_000_000_000);
    expect([43, 47, 51, 55, 59].map((at) => data.getFloat32(stride + at, true))).toEqual([0, 0.5, -1, NaN, 9]);
  });

  it("holds a mesh: vertices without radii, then the triangles", async () => {
    const vertices = store();
    const { lines, data } = await parse(vertices, meshPlyOf({ vertices, triangles: Uint32Array.of(0, 1, 7, 2, 3, 4_000_000_000) }));
    expect(lines).toContain("element vertex 2");
    expect(lines).toContain("element face 2");
    expect(properties(lines)).toEqual([
      ...["x", "y", "z", "nx", "ny", "nz"].map((name) => `float ${name}`),
      "list uchar uint vertex_indices",
    ]);
    expect(data.byteLength).toBe(2 * 24 + 2 * 13);
    expect(data.getFloat32(24, true)).toBe(4);
    for (const [i, corners] of [
      [0, [0, 1, 7]],
      [1, [2, 3, 4_000_000_000]],
    ] as const) {
      const at = 48 + 13 * i;
      expect([data.getUint8(at), ...[1, 5, 9].map((k) => data.getUint32(at + k, true))]).toEqual([3, ...corners]);
    }
  });
});
