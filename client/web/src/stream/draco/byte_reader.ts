// SPDX-License-Identifier: Apache-2.0
// Reads numbers off the front of Draco data, which may end too early.

import { badPoints } from "../decoded_points";

/// Reads bytes that it does not own. Throws DATA_LOSS where they end too early.
export class ByteReader {
  private readonly view: DataView;

  constructor(
    private readonly bytes: Uint8Array,
    private at = 0,
  ) {
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  }

  /// Number of bytes read so far.
  get position(): number {
    return this.at;
  }

  u8(): number {
    return this.bytes[this.advance(1)]!;
  }

  i8(): number {
    return this.view.getInt8(this.advance(1));
  }

  u16(): number {
    return this.view.getUint16(this.advance(2), true);
  }

  i32(): number {
    return this.view.getInt32(this.advance(4), true);
  }

  f32(): number {
    return this.view.getFloat32(this.advance(4), true);
  }

  /// Reads a number of seven bits a byte, the lowest first.
  varint(): number {
    let value = 0;
    for (let scale = 1; scale < 2 ** 64; scale *= 128) {
      const byte = this.u8();
      value += (byte & 127) * scale;
      if (byte < 128) return value;
    }
    throw badPoints("Draco data with a number that is too long");
  }

  take(count: number): Uint8Array {
    const begin = this.advance(count);
    return this.bytes.subarray(begin, begin + count);
  }

  private advance(count: number): number {
    const begin = this.at;
    if (count > this.bytes.length - begin) throw badPoints("Draco data that ends too early");
    this.at = begin + count;
    return begin;
  }
}
