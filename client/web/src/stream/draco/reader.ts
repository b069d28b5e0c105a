// SPDX-License-Identifier: Apache-2.0
// Decodes the Draco point clouds that Curvecast's servers send, several times as fast as Draco's own decoder and with nothing to
// load: points one after the other (Draco's sequential method), quantised positions, octahedral normals, one-byte radii, one-byte
// colours, all as differences.

import { badPoints, type DecodedPoints } from "../decoded_points";
import { ByteReader } from "./byte_reader";
import { blockAttributes, colour, normal, position, radius, type DracoAttribute, type DracoHeader } from "./header";
import { SymbolReader } from "./symbol_reader";
import { OctahedralValues, WrappedValues } from "./symbol_values";

// Draco's numbers for how attributes are stored, predicted and corrected.
const storedInteger = 1;
const storedQuantised = 2;
const storedNormal = 3;
const predictDifference = 0;
const correctWrapped = 1;
const correctOctahedral = 3;

const part = 1024; // points at a time: they stay in a fast cache

/// Where the points of a block go: arrays of the block's size, but colours are null where it has none.
export type Columns = Pick<DecodedPoints, "count" | "positions" | "normals" | "colours">;

/// Keeps tables and memory from block to block.
export class DracoReader {
  private readonly readers = new Map(blockAttributes.map(({ kind }) => [kind, new SymbolReader()]));
  private readonly values = new Int32Array(4 * part);

  /// Writes the points of data with this header; `radii` are those of the codes. False: this is another kind of Draco data, and
  /// nothing was written. Throws when it is broken, ends too early, or its values leave the bounds that it states.
  read(bytes: Uint8Array, header: DracoHeader, radii: Float32Array, to: Columns): boolean {
    if (!isOurs(header)) return false;
    const from = new ByteReader(bytes, header.size);
    const stored = header.attributes.map(() => from.u8());
    if (stored.some((how, i) => how !== storedAs(header.attributes[i]!))) return false;
    const values = new Map<number, WrappedValues | OctahedralValues>();
    for (const { kind, components } of header.attributes) {
      const octahedral = kind === normal.kind;
      if (from.i8() !== predictDifference || from.i8() !== (octahedral ? correctOctahedral : correctWrapped)) return false;
      this.readers.get(kind)!.open(from, header.points, octahedral ? 2 : components);
      const read = octahedral ? OctahedralValues.read(from) : WrappedValues.read(from);
      if (read === null) return false;
      values.set(kind, read);
    }
    for (const { kind } of header.attributes) {
      const of = values.get(kind)!;
      if (of instanceof OctahedralValues) {
        if (from.u8() !== of.bits) throw badPoints("Draco normals of two different numbers of bits");
        const normals = new Int32Array(to.normals.buffer, to.normals.byteOffset, to.count);
        this.eachPart(kind, to.count, (symbols, begin, count) => of.decode(symbols, count, normals.subarray(begin)));
      } else if (kind === position.kind) {
        this.readPositions(from, of, to);
      } else if (kind === radius.kind) {
        this.eachPart(kind, to.count, (numbers, begin, count) => {
          of.decode(numbers, count, 1);
          for (let i = 0; i < count; ++i) to.positions[4 * (begin + i) + 3] = radii[numbers[i]! & 255]!;
        });
      } else {
        this.readColours(of, to);
      }
    }
    return true;
  }

  private readPositions(from: ByteReader, numbers: WrappedValues, { positions, count }: Columns): void {
    const [x, y, z] = [from.f32(), from.f32(), from.f32()];
    const range = from.f32();
    const bits = from.u8();
    if (bits < 1 || bits > 30) throw badPoints("Draco positions of impossible bits");
    const delta = Math.fround(range / Math.fround(2 ** bits - 1));
    for (const end of [numbers.min, numbers.max]) {
      // Between two finite positions all are.
      if (![x, y, z].every((low) => Number.isFinite(Math.fround(end * delta + low))))
        throw badPoints("a position that is not finite");
    }
    const fround = Math.fround;
    this.eachPart(position.kind, count, (values, begin, points) => {
      numbers.decode(values, points, 3);
      for (let i = 0, slot = 4 * begin; i < 3 * points; i += 3, slot += 4) {
        positions[slot] = fround(fround(values[i]!) * delta) + x;
        positions[slot + 1] = fround(fround(values[i + 1]!) * delta) + y;
        positions[slot + 2] = fround(fround(values[i + 2]!) * delta) + z;
      }
    });
  }

  private readColours(numbers: WrappedValues, { colours, count }: Columns): void {
    this.eachPart(colour.kind, count, (values, begin, points) => {
      numbers.decode(values, points, 3);
      for (let i = 0, slot = 4 * begin; i < 3 * points; i += 3, slot += 4) {
        for (let c = 0; c < 3; ++c) colours![slot + c] = values[i + c]!;
        colours![slot + 3] = 255;
      }
    });
  }

  private eachPart(kind: number, points: number, decode: (symbols: Int32Array, begin: number, count: number) => void): void {
    const symbols = this.readers.get(kind)!;
    for (let begin = 0; begin < points; begin += part) {
      const count = Math.min(part, points - begin);
      symbols.read(count, this.values);
      decode(this.values, begin, count);
    }
    if (!symbols.hadEnough()) throw badPoints("Draco symbols that end too early");
  }
}

/// The attributes of a block, and no others.
function isOurs({ attributes }: DracoHeader): boolean {
  return attributes.every((a) => blockAttributes.some(({ kind }) => kind === a.kind) && isFirst(a, attributes));
}

function isFirst(attribute: DracoAttribute, attributes: readonly DracoAttribute[]): boolean {
  return attributes.find(({ kind }) => kind === attribute.kind) === attribute;
}

function storedAs({ kind }: DracoAttribute): number {
  return kind === position.kind ? storedQuantised : kind === normal.kind ? storedNormal : storedInteger;
}
