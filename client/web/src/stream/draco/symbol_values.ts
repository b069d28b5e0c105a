// SPDX-License-Identifier: Apache-2.0
// Turns the symbols of a Draco attribute into its values: each is a difference to the point before, on a lattice. All of a value's
// arithmetic is that of 32-bit integers and floats, so that the values are those of Draco's decoder to the bit.

import { badPoints } from "../decoded_points";
import type { ByteReader } from "./byte_reader";

const maxComponents = 4;
const maxNormalBits = 30;
const maxDecodedBits = 15; // turnInsideOut() has room for no more
const maxKnownBits = 8; // normals of so many bits are kept: 256 KiB

/// Whole numbers, all between two bounds; a sum that leaves them re-enters on the other side.
export class WrappedValues {
  private readonly previous = new Int32Array(maxComponents);

  private constructor(
    readonly min: number,
    readonly max: number,
  ) {
    this.previous.fill(Math.min(Math.max(0, min), max));
  }

  /// Takes the bounds off the front of the bytes.
  static read(bytes: ByteReader): WrappedValues {
    const [min, max] = [bytes.i32(), bytes.i32()];
    if (min > max || max - min >= 0x7fffffff) throw badPoints("Draco values of impossible bounds");
    return new WrappedValues(min, max);
  }

  /// Replaces the symbols of the next points, component by component, by their numbers. Throws where one leaves the bounds: no
  /// encoder writes that.
  decode(values: Int32Array, points: number, components: number): void {
    const { min, max } = this;
    const size = (max - min + 1) | 0;
    let outside = 0;
    for (let c = 0; c < components; ++c) {
      let value = this.previous[c]!;
      for (let i = c; i < components * points; i += components) {
        const symbol = values[i]!;
        value = (value + ((symbol >>> 1) ^ -(symbol & 1))) | 0; // the lowest bit is the sign: 0, -1, 1, -2, ...
        if (value > max) value = (value - size) | 0;
        else if (value < min) value = (value + size) | 0;
        if (value > max || value < min) ++outside;
        values[i] = value;
      }
      this.previous[c] = value;
    }
    if (outside > 0) throw badPoints("Draco values that leave the bounds they state");
  }
}

/// Unit vectors on an octahedron that is unfolded to a square of (2 centre + 1)^2 cells, centre = 2^(bits - 1) - 1.
export class OctahedralValues {
  private s: number; // of the point before, from the centre
  private t: number;

  private constructor(
    readonly bits: number,
    private readonly centre: number,
  ) {
    this.s = this.t = -centre;
  }

  /// Takes the bounds off the front of the bytes. Null where these are of more bits than decode() can do.
  static read(bytes: ByteReader): OctahedralValues | null {
    const largest = bytes.i32(); // 2^bits - 1; then half of that
    bytes.i32();
    const bits = 32 - Math.clz32(largest);
    if (bits < 2 || bits > maxNormalBits || (largest & 1) === 0) throw badPoints("Draco normals of impossible bounds");
    return bits > maxDecodedBits ? null : new OctahedralValues(bits, 2 ** (bits - 1) - 1);
  }

  /// Turns the symbols of the next points, two for each, into normals as packNormal() gives them. Throws where a symbol is outside
  /// of the square.
  decode(symbols: Int32Array, points: number, to: Int32Array): void {
    const { centre } = this;
    const width = 2 * centre + 1;
    const known = knownNormals(this.bits);
    let { s, t } = this;
    for (let i = 0; i < points; ++i) {
      const a = symbols[2 * i]!;
      const b = symbols[2 * i + 1]!;
      if (a >>> 0 >= width || b >>> 0 >= width) throw badPoints("a Draco normal that leaves its bounds");
      // Outside of the diamond |s| + |t| <= centre, the front half of the octahedron, it is turned inside out with the corners.
      const isInCorner = Math.abs(s) + Math.abs(t) > centre;
      if (isInCorner) {
        const turned = turnInsideOut(centre, s, t);
        s = turned >> 16;
        t = (turned << 16) >> 16;
      }
      // Differences are stored as if the point before lay in the quadrant s < 0, t <= 0, and are turned to where it lies.
      if (s < 0 ? t <= 0 : s === 0 && t === 0) {
        s = wrap(s + a, centre, width);
        t = wrap(t + b, centre, width);
      } else if (s >= 0 && t < 0) {
        s = wrap(s - b, centre, width);
        t = wrap(t + a, centre, width);
      } else if (s > 0) {
        s = wrap(s - a, centre, width);
        t = wrap(t - b, centre, width);
      } else {
        s = wrap(s + b, centre, width);
        t = wrap(t - a, centre, width);
      }
      if (isInCorner) {
        const turned = turnInsideOut(centre, s, t);
        s = turned >> 16;
        t = (turned << 16) >> 16;
      }
      if (known === null) {
        to[i] = packNormal(s, t, centre);
      } else {
        const cell = (s + centre) * width + t + centre;
        const normal = known[cell]!;
        to[i] = normal === 0 ? (known[cell] = packNormal(s, t, centre)) : normal;
      }
    }
    this.s = s;
    this.t = t;
  }
}

function wrap(x: number, centre: number, width: number): number {
  return x > centre ? x - width : x < -centre ? x + width : x;
}

/// Exchanges the inside of the diamond with the corners around it: the new s in the upper 16 bits, t in the lower.
function turnInsideOut(centre: number, s: number, t: number): number {
  const isFirst = s >= 0 && t >= 0;
  if (isFirst || (s <= 0 && t <= 0)) {
    const corner = isFirst ? centre : -centre;
    return ((corner - t) << 16) | ((corner - s) & 0xffff);
  }
  const corner = s > 0 ? centre : -centre;
  return ((t + corner) << 16) | ((s - corner) & 0xffff);
}

/// The unit normal of a cell: x, y, z as signed bytes, 127 for 1, from the lowest byte on, and 0.
function packNormal(s: number, t: number, centre: number): number {
  const v = (s + centre) / centre - 1;
  const w = (t + centre) / centre - 1;
  const x = 1 - Math.abs(v) - Math.abs(w);
  const beyond = x < 0 ? -x : 0;
  const y = v + (v < 0 ? beyond : -beyond);
  const z = w + (w < 0 ? beyond : -beyond);
  const toBytes = 127 / Math.hypot(x, y, z); // of 1/3 at least
  const [bx, by, bz] = [Math.round(x * toBytes), Math.round(y * toBytes), Math.round(z * toBytes)];
  return (bx & 255) | ((by & 255) << 8) | ((bz & 255) << 16);
}

const tables = new Map<number, Int32Array>();

/// Those of all cells, where these are few: 0 where it was not yet asked for (no normal is 0).
function knownNormals(bits: number): Int32Array | null {
  if (bits > maxKnownBits) return null;
  let table = tables.get(bits);
  if (table === undefined) tables.set(bits, (table = new Int32Array((2 ** bits - 1) ** 2)));
  return table;
}
