// SPDX-License-Identifier: Apache-2.0
// Reads the whole numbers of a Draco attribute: as bytes, entropy-coded, or as bits whose number is entropy-coded.

import { badPoints } from "../decoded_points";
import type { ByteReader } from "./byte_reader";
import { RansReader } from "./rans_reader";

const taggedScheme = 0;
const rawScheme = 1;
const tagBits = 5; // of the number of bits in a tag
const maxRawBits = 18; // of a symbol without a tag
const maxTag = 32;
const part = 4096;

/// Keeps its memory from attribute to attribute: a byte per point at most, beside RansReader's.
export class SymbolReader {
  private coding: "bytes" | "entropy" | "tagged" = "bytes";
  private components = 0;
  private readonly rans = new RansReader();
  private data: Uint8Array = new Uint8Array(0); // bytes or bits
  private at = 0; // bytes or bits of it, taken so far
  private width = 0; // bytes per symbol
  private tags = new Uint8Array(0); // bits per symbol, of every point
  private point = 0; // where the tagged ones have come to

  /// Takes `points` times `components` symbols off the front of `bytes`. Throws where they are broken or not all there.
  open(bytes: ByteReader, points: number, components: number): void {
    this.components = components;
    this.at = this.point = 0;
    if (bytes.u8() === 0) return this.openBytes(bytes, points);
    const scheme = bytes.u8();
    if (scheme === rawScheme) return this.openEntropy(bytes);
    if (scheme === taggedScheme) return this.openTagged(bytes, points);
    throw badPoints("Draco symbols of an unknown scheme");
  }

  /// Those of the next `points`, as their 32 bits.
  read(points: number, to: Int32Array): void {
    if (this.coding === "entropy") this.rans.read(points * this.components, to);
    else if (this.coding === "bytes") this.readBytes(points, to);
    else this.readTagged(points, to);
  }

  /// As RansReader.hadEnough().
  hadEnough(): boolean {
    return this.coding !== "entropy" || this.rans.hadEnough();
  }

  private openBytes(bytes: ByteReader, points: number): void {
    this.coding = "bytes";
    this.width = bytes.u8();
    if (this.width > 4) throw badPoints("Draco values of more than four bytes");
    this.data = bytes.take(points * this.components * this.width);
  }

  private openEntropy(bytes: ByteReader): void {
    this.coding = "entropy";
    const bits = bytes.u8();
    if (bits === 0 || bits > maxRawBits) throw badPoints("Draco symbols that are too long");
    this.rans.open(bytes, precisionOf(bits));
  }

  private openTagged(bytes: ByteReader, points: number): void {
    this.coding = "tagged";
    this.rans.open(bytes, precisionOf(tagBits));
    // Only all tags together say where the bits end.
    this.tags = new Uint8Array(points);
    const tags = new Int32Array(part);
    let bits = 0;
    for (let begin = 0; begin < points; begin += part) {
      const count = Math.min(part, points - begin);
      this.rans.read(count, tags);
      for (let i = 0; i < count; ++i) {
        const tag = tags[i]! >>> 0;
        if (tag > maxTag) throw badPoints("Draco values of more than 32 bits");
        this.tags[begin + i] = tag;
        bits += this.components * tag;
      }
    }
    if (!this.rans.hadEnough()) throw badPoints("Draco symbols that end too early");
    this.data = bytes.take(Math.ceil(bits / 8));
  }

  private readBytes(points: number, to: Int32Array): void {
    for (let i = 0; i < points * this.components; ++i) {
      to[i] = 0;
      for (let k = 0; k < this.width; ++k) to[i]! |= this.data[this.at++]! << (8 * k);
    }
  }

  private readTagged(points: number, to: Int32Array): void {
    let next = 0;
    for (let i = 0; i < points; ++i) {
      const tag = this.tags[this.point++]!;
      for (let c = 0; c < this.components; ++c) to[next++] = this.bits(tag);
    }
  }

  private bits(count: number): number {
    let value = 0;
    for (let i = 0; i < count; ++i, ++this.at) value |= ((this.data[this.at >> 3]! >> (this.at & 7)) & 1) << i;
    return value;
  }
}

/// Bits of the sum of the frequencies of symbols of so many bits.
function precisionOf(symbolBits: number): number {
  return Math.min(Math.max(Math.floor((3 * symbolBits) / 2), 12), 20);
}
