import { describe, expect, it } from "vitest";

import { cloudAmong } from "../../../../../client/web/src/cloud/cloud_files";
import { fileOf } from "./files";

const ply = (...elements: string[]): Blob =>
  fileOf(
    [
      "ply",
      "format ascii 1.0",
      "comment element face 7",
      "element vertex 1",
      "property float x",
      ...elements,
      "end_header",
      "",
    ].join("\n"),
  );
const cloudOf = async (files: Record<string, Blob>): Promise<string | null> =>
  (await cloudAmong(Object.entries(files).map(([name, data]) => ({ name, data }))))?.name ?? null;

const some = fileOf("1 2 3\n");

describe("a cloud among files", () => {
  it("is one by its name", async () => {
    for (const name of ["a.xyz", "b.TXT", "c.asc", "d.pts", "e.csv", "f.las", "g.laz"])
      expect(await cloudOf({ [name]: some })).toBe(name);
    for (const name of ["a.obj", "b.stl", "c", "d.png"]) expect(await cloudOf({ [name]: some })).toBeNull();
  });

  it("is a PLY file without faces", async () => {
    expect(await cloudOf({ "a.ply": ply() })).toBe("a.ply");
    expect(await cloudOf({ "a.ply": ply("element face 0", "property list uchar int vertex_indices") })).toBe("a.ply");
    expect(await cloudOf({ "a.ply": ply("element face 2", "property list uchar int vertex_indices") })).toBeNull();
    expect(await cloudOf({ "a.ply": ply("element tristrips 1", "property list int int vertex_indices") })).toBeNull();
  });

  it("is none where the server can say what is wrong with the file", async () => {
    expect(await cloudOf({ "a.ply": fileOf("ply\nformat ascii 1.0\n") })).toBeNull();
    expect(await cloudOf({ "a.ply": fileOf() })).toBeNull();
  });

  it("is none where there is a mesh, whose readme may come with it", async () => {
    expect(await cloudOf({ "readme.txt": some, "a.obj": some })).toBeNull();
    expect(await cloudOf({ "leaf.png": some, "a.xyz": some })).toBe("a.xyz");
  });
});
