import { describe, expect, it } from "vitest";

import { droppedFiles, filesBelow } from "../../../../client/web/src/app/dropped_files";

function file(name: string): FileSystemEntry {
  return { name, isFile: true, file: (take: (file: File) => void) => take({ name } as File) } as unknown as FileSystemEntry;
}

/// Tells its children two at a time.
function folder(name: string, ...children: FileSystemEntry[]): FileSystemEntry {
  return {
    name,
    isFile: false,
    createReader: () => {
      const left = [...children];
      return { readEntries: (take: (some: FileSystemEntry[]) => void) => take(left.splice(0, 2)) };
    },
  } as unknown as FileSystemEntry;
}

const namesOf = (files: { name: string }[]) => files.map(({ name }) => name);

describe("what was dropped", () => {
  it("are files, and those below folders by their paths there", async () => {
    const maps = folder("maps", file("a.png"), folder("deep", file("b.png")));
    const tree = folder("spot", maps, file(".hidden"), file("c.mtl"), file("d.obj"));
    expect(namesOf(await filesBelow([tree, file("e.ply")]))).toEqual(["e.ply", "c.mtl", "d.obj", "maps/a.png", "maps/deep/b.png"]);
  });

  it("ends, however much there is", async () => {
    const endless: FileSystemEntry = folder("endless");
    const readEntries = (take: (some: FileSystemEntry[]) => void) => take([endless, endless]);
    Object.assign(endless, { createReader: () => ({ readEntries }) });
    expect(await filesBelow([endless], 50)).toEqual([]);
    const full = folder("full", ...Array.from({ length: 80 }, (_, i) => file(`${i}.png`)));
    expect((await filesBelow([full], 50)).length).toBe(50);
  });

  it("cannot be read: it says so", async () => {
    const broken = { name: "x", isFile: true, file: (_: unknown, fail: (error: Error) => void) => fail(new Error("gone")) };
    await expect(filesBelow([broken as unknown as FileSystemEntry])).rejects.toThrow("gone");
  });

  it("are plain files where the browser tells no entries", async () => {
    const transfer = { items: [{ kind: "file", webkitGetAsEntry: () => null }], files: [{ name: "a.off" }] };
    expect(namesOf(await droppedFiles(transfer as unknown as DataTransfer))).toEqual(["a.off"]);
  });
});
