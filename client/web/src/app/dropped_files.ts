// SPDX-License-Identifier: Apache-2.0
// The files of a drop, with those in dropped folders.

import type { NamedFile } from "../stream";

const maxFiles = 2000;

/// Lists the files that were dropped, and those below dropped folders, which are named by their paths below the folder. Returns 2,000 at
/// most, those of the upper folders first, and leaves hidden files out. Must be called while the drop event is handled. Rejects where a
/// file cannot be read.
export function droppedFiles(transfer: DataTransfer): Promise<NamedFile[]> {
  const items = [...transfer.items].filter(({ kind }) => kind === "file");
  const entries = items.map((item) => item.webkitGetAsEntry());
  if (!entries.every((entry) => entry !== null)) {
    return Promise.resolve([...transfer.files].map((file) => ({ name: file.name, data: file })));
  }
  return filesBelow(entries);
}

/// Lists files as droppedFiles() does, `max` at most.
export async function filesBelow(entries: readonly FileSystemEntry[], max = maxFiles): Promise<NamedFile[]> {
  const files: NamedFile[] = [];
  const waiting = entries.map((entry) => ({ entry, path: entry.isFile ? entry.name : "" }));
  let seen = 0; // counts empty folders, too, so that any number of them comes to an end
  for (let next = waiting.shift(); next !== undefined && files.length < max && seen < 2 * max; next = waiting.shift()) {
    const { entry, path } = next;
    seen += 1;
    if (entry.name.startsWith(".")) continue;
    if (entry.isFile) files.push({ name: path, data: await fileOf(entry as FileSystemFileEntry) });
    else {
      const children = await childrenOf(entry as FileSystemDirectoryEntry, max);
      const below = path === "" ? "" : `${path}/`;
      waiting.push(...children.map((child) => ({ entry: child, path: below + child.name })));
    }
  }
  return files;
}

function fileOf(entry: FileSystemFileEntry): Promise<File> {
  return new Promise((resolve, reject) => entry.file(resolve, reject));
}

async function childrenOf(folder: FileSystemDirectoryEntry, max: number): Promise<FileSystemEntry[]> {
  const reader = folder.createReader();
  const children: FileSystemEntry[] = [];
  while (children.length < max) {
    // Browsers give a hundred entries at a time.
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) break;
    children.push(...some);
  }
  return children;
}
