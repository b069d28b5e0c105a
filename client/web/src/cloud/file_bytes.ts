// SPDX-License-Identifier: Apache-2.0
// Reads a file's bytes one block after the other, so that files of any size take little memory.

/// Told how many bytes of the file have been read.
export type OnRead = (bytes: number) => void;

const blockBytes = 4 << 20;

/// Returns the bytes [begin, end) of a file, or what there is of them.
export async function bytesAt(file: Blob, begin: number, end: number): Promise<Uint8Array<ArrayBuffer>> {
  return new Uint8Array(await file.slice(begin, Math.max(begin, end)).arrayBuffer());
}

/// Yields the bytes from `begin` on, in blocks.
export async function* blocksOf(file: Blob, begin: number, onRead: OnRead): AsyncGenerator<Uint8Array> {
  for (let at = begin; at < file.size; at += blockBytes) {
    yield await bytesAt(file, at, at + blockBytes);
    onRead(Math.min(at + blockBytes, file.size));
  }
}

/// Yields records of `size` bytes from `begin` on, many at a time: `count` of all blocks together, or as many whole ones as the file has.
export async function* recordsOf(
  file: Blob,
  begin: number,
  size: number,
  count: number,
  onRead: OnRead,
): AsyncGenerator<{ view: DataView; records: number }> {
  const all = Math.min(count, Math.max(0, Math.floor((file.size - begin) / size)));
  const most = Math.max(1, Math.floor(blockBytes / size));
  for (let done = 0; done < all;) {
    const records = Math.min(most, all - done);
    const bytes = await bytesAt(file, begin + done * size, begin + (done + records) * size);
    yield { view: new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), records };
    done += records;
    onRead(begin + done * size);
  }
}

/// A place in a file, for what has no fixed size.
export class FileCursor {
  private buffer = new DataView(new ArrayBuffer(0));
  private bufferAt = 0; // in the file

  constructor(
    private readonly file: Blob,
    /// Bytes from the file's beginning.
    public at: number,
  ) {}

  /// Returns the next `bytes` bytes, and goes past them; null where the file ends before. Precondition: at most a block of 4 MiB.
  async take(bytes: number): Promise<DataView | null> {
    if (this.at + bytes > this.bufferAt + this.buffer.byteLength || this.at < this.bufferAt) {
      if (this.at + bytes > this.file.size) return null;
      const read = await bytesAt(this.file, this.at, this.at + Math.max(bytes, blockBytes));
      this.buffer = new DataView(read.buffer);
      this.bufferAt = this.at;
    }
    const view = new DataView(this.buffer.buffer, this.at - this.bufferAt, bytes);
    this.at += bytes;
    return view;
  }
}
