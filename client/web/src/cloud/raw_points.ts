// SPDX-License-Identifier: Apache-2.0
// Points as a file has them, before anything is known about their neighbours.

import { countText, pointsText } from "./words";

/// The most points that are kept of a file.
export const maxCloudPoints = 10_000_000;

const farthest = 1e15; // coordinates beyond it are no places: squares of lengths have to fit into 32 bits of the graphics card
const firstRoom = 1 << 14; // points

/// What a reader has found. All arrays may be longer than `count` asks for.
export interface RawPoints {
  count: number;
  /// 3 a point: x, y, z in the file's own frame.
  positions: Float64Array;
  /// 3 a point, of any length; null where the file has none.
  normals: Float32Array | null;
  /// 3 a point: red, green, blue (sRGB); null where the file has none.
  colours: Uint8Array | null;
  /// What the user is to know, as sentences.
  notices: string[];
}

/// Keeps points one after the other: all of them, or evenly every so many where there are more than `most`. `width`: further values that
/// each point has.
export class PointSink {
  count = 0;
  /// Points that were given.
  seen = 0;
  positions: Float64Array;
  /// `width` a point. add() may replace the array.
  extras: Float32Array;
  private nowhere = 0; // points whose coordinates are no numbers
  private step = 1; // one of so many points is kept
  private room: number;

  constructor(
    readonly width: number,
    private readonly most = maxCloudPoints,
  ) {
    this.room = Math.min(firstRoom, most);
    this.positions = new Float64Array(3 * this.room);
    this.extras = new Float32Array(width * this.room);
  }

  /// Takes the next point. Returns its number, under which its extras are to be written; -1: it is left out.
  add(x: number, y: number, z: number): number {
    const which = this.seen++;
    if (this.step > 1 && which % this.step !== 0) return -1;
    // False for NaN, too.
    if (!(Math.abs(x) <= farthest && Math.abs(y) <= farthest && Math.abs(z) <= farthest)) {
      this.nowhere += this.step;
      return -1;
    }
    if (this.count === this.room) this.makeRoom();
    if (this.step > 1 && which % this.step !== 0) return -1;
    const at = 3 * this.count;
    this.positions[at] = x;
    this.positions[at + 1] = y;
    this.positions[at + 2] = z;
    return this.count++;
  }

  /// Says what was left out.
  get notices(): string[] {
    const { nowhere, step, count } = this;
    return [
      ...(nowhere > 0
        ? [`${step > 1 ? "About " : ""}${pointsText(nowhere)} without a place ${nowhere === 1 ? "was" : "were"} left out`]
        : []),
      ...(step > 1 ? [`One of ${pointsText(step)} is shown: ${countText(count)} of ${countText(this.seen)}`] : []),
    ];
  }

  private makeRoom(): void {
    if (this.room === this.most) return this.halve();
    this.room = Math.min(2 * this.room, this.most);
    const [positions, extras] = [this.positions, this.extras];
    this.positions = new Float64Array(3 * this.room);
    this.positions.set(positions);
    this.extras = new Float32Array(this.width * this.room);
    this.extras.set(extras);
  }

  /// Drops every other point, and from now on every other one that would have been kept.
  private halve(): void {
    const { positions, extras, width } = this;
    const kept = Math.ceil(this.count / 2);
    for (let to = 1; to < kept; ++to) {
      positions.copyWithin(3 * to, 6 * to, 6 * to + 3);
      extras.copyWithin(width * to, 2 * width * to, 2 * width * to + width);
    }
    this.count = kept;
    this.step *= 2;
  }
}

/// Copies `size` values a point that begin at `first` of its extras.
export function columnsOf({ extras, width, count }: PointSink, first: number, size: number): Float32Array {
  const out = new Float32Array(size * count);
  for (let i = 0; i < count; ++i) for (let k = 0; k < size; ++k) out[size * i + k] = extras[width * i + first + k]!;
  return out;
}

/// Makes bytes of colours whose values are `scale` where a byte is 255.
export function bytesOf(colours: Float32Array, scale: number): Uint8Array {
  const out = new Uint8Array(colours.length);
  for (let i = 0; i < out.length; ++i) {
    const value = Math.round((255 * colours[i]!) / scale);
    out[i] = value > 0 ? Math.min(value, 255) : 0; // NaN is none
  }
  return out;
}

/// Makes greys of values: black and white are their quantiles of 1 and 99 %. Returns null where all values are the same.
export function greysOf(values: Float32Array): Uint8Array | null {
  const step = Math.max(1, Math.floor(values.length / 10_000));
  const sample = values.filter((value, i) => i % step === 0 && Number.isFinite(value)).sort();
  const at = (share: number): number => sample[Math.round(share * (sample.length - 1))] ?? 0;
  const [least, most] = [at(0.01), at(0.99)];
  if (!(most > least)) return null;
  const out = new Uint8Array(3 * values.length);
  values.forEach((value, i) => out.fill(255 * Math.min(Math.max((value - least) / (most - least), 0), 1) || 0, 3 * i, 3 * i + 3));
  return out;
}
