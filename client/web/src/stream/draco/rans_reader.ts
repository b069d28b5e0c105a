// SPDX-License-Identifier: Apache-2.0
// Decodes the entropy coding of Draco: rANS after J. Duda, "Asymmetric numeral systems" (2013), arXiv:1311.2540, byte by byte from
// the back, in the table layout of Draco's bitstream 2.

import { badPoints } from "../decoded_points";
import type { ByteReader } from "./byte_reader";

const zeroRun = 3; // of the low two bits of a table's byte; other values: how many bytes follow
const maxTableBits = 15; // beyond, a table would be larger than what is read with it
const indexBits = 12;

/// One stream of symbols. Keeps its memory from stream to stream; that grows with the bytes of a table, never with the counts that
/// they claim.
export class RansReader {
  private precision = 0; // bits of the sum of the frequencies
  // The symbols that occur, where their parts of the low bits begin, and one start behind them.
  private slots = 0;
  private starts = new Uint32Array(0);
  private symbols = new Uint32Array(0);
  // For every value of the low bits, where there are few of them: frequency << 16 | offset, and the symbol.
  private readonly steps = new Uint32Array(1 << maxTableBits);
  private readonly symbolOf = new Uint32Array(1 << maxTableBits);
  // Else the first slot for every value of the highest of the low bits.
  private readonly first = new Uint32Array(1 << indexBits);

  private state = 0;
  private bytes: Uint8Array = new Uint8Array(0); // the stream
  private end = 0; // of what is left of it

  /// Takes a table of frequencies that sum to 2^precision (12 .. 20), then a stream, off the front of `from`. Throws where they are
  /// broken.
  open(from: ByteReader, precision: number): void {
    this.precision = precision;
    this.readTable(from);
    if (precision <= maxTableBits) this.fillTable();
    else this.indexSlots();
    this.start(from);
  }

  /// The next `count` symbols. A broken stream gives arbitrary symbols of the table.
  read(count: number, to: Int32Array): void {
    if (this.precision <= maxTableBits) this.readByTable(count, to);
    else this.readBySearch(count, to);
  }

  /// False when symbols were read that the bytes did not hold. Ask after the last one.
  hadEnough(): boolean {
    const least = 4 << this.precision;
    let { state, end } = this;
    while (state < least && end > 0) state = (state << 8) | this.bytes[--end]!;
    return state >= least;
  }

  // Every step appends bytes to the state until it is at least four times the sum of the frequencies, as long as there are any, and
  // then takes the symbol of its low bits out.

  private readByTable(count: number, to: Int32Array): void {
    const { bytes, steps, symbolOf, precision } = this;
    const least = 4 << precision;
    const mask = (1 << precision) - 1;
    let { state, end } = this;
    for (let i = 0; i < count; ++i) {
      while (state < least && end > 0) state = (state << 8) | bytes[--end]!;
      const low = state & mask;
      const step = steps[low]!;
      to[i] = symbolOf[low]!;
      state = Math.imul(state >>> precision, step >>> 16) + (step & 0xffff);
    }
    this.state = state;
    this.end = end;
  }

  private readBySearch(count: number, to: Int32Array): void {
    const { bytes, starts, symbols, first, precision } = this;
    const least = 4 << precision;
    const mask = (1 << precision) - 1;
    const shift = precision - indexBits;
    let { state, end } = this;
    for (let i = 0; i < count; ++i) {
      while (state < least && end > 0) state = (state << 8) | bytes[--end]!;
      const low = state & mask;
      let slot = first[low >>> shift]!;
      while (starts[slot + 1]! <= low) ++slot;
      const start = starts[slot]!;
      to[i] = symbols[slot]!;
      state = Math.imul(state >>> precision, starts[slot + 1]! - start) + (low - start);
    }
    this.state = state;
    this.end = end;
  }

  private readTable(from: ByteReader): void {
    const total = 1 << this.precision;
    const claimed = from.varint();
    let sum = 0;
    this.slots = 0;
    for (let symbol = 0; symbol < claimed; ++symbol) {
      const byte = from.u8();
      const more = byte & 3;
      let frequency = byte >> 2;
      if (more === zeroRun) {
        if (frequency >= claimed - symbol) throw badPoints("a Draco table that is longer than it claims");
        symbol += frequency;
        continue;
      }
      for (let i = 0; i < more; ++i) frequency |= from.u8() << (8 * i + 6);
      if (frequency > total - sum) throw badPoints("a Draco table of too large frequencies");
      if (frequency > 0) this.addSlot(sum, symbol);
      sum += frequency;
    }
    if (sum !== total) throw badPoints("a Draco table of too small frequencies");
    this.addSlot(sum, 0);
    --this.slots;
  }

  private addSlot(start: number, symbol: number): void {
    if (this.slots === this.starts.length) {
      this.starts = grown(this.starts);
      this.symbols = grown(this.symbols);
    }
    this.starts[this.slots] = start;
    this.symbols[this.slots++] = symbol;
  }

  private fillTable(): void {
    for (let slot = 0; slot < this.slots; ++slot) {
      const start = this.starts[slot]!;
      const end = this.starts[slot + 1]!;
      for (let i = start; i < end; ++i) this.steps[i] = ((end - start) << 16) | (i - start);
      this.symbolOf.fill(this.symbols[slot]!, start, end);
    }
  }

  private indexSlots(): void {
    let slot = 0;
    for (let i = 0; i < this.first.length; ++i) {
      while (this.starts[slot + 1]! <= i << (this.precision - indexBits)) ++slot;
      this.first[i] = slot;
    }
  }

  private start(from: ByteReader): void {
    this.bytes = from.take(from.varint());
    // The last byte says in two bits how many more belong to the first state, which is stored less its smallest value.
    const stateBytes = 1 + ((this.bytes.at(-1) ?? 255) >> 6);
    this.end = this.bytes.length - stateBytes;
    if (this.end < 0) throw badPoints("Draco symbols that end too early");
    let stored = 0;
    for (let i = 0; i < stateBytes; ++i) stored |= this.bytes[this.end + i]! << (8 * i);
    const least = 4 << this.precision;
    this.state = least + (stored & (2 ** (8 * stateBytes - 2) - 1));
    if (this.state >= least * 256) throw badPoints("Draco symbols that begin with an impossible state");
  }
}

function grown(array: Uint32Array): Uint32Array<ArrayBuffer> {
  const result = new Uint32Array(2 * array.length + 256);
  result.set(array);
  return result;
}
