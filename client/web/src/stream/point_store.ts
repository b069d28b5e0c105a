// SPDX-License-Identifier: Apache-2.0
// The points of a stream, in arrays that go to the graphics card unchanged.

import type { PointEdits } from "../gen/curvecast/v1/curvecast_pb";
import { ChangedSlots, type PointChanges } from "./changed_slots";
import { badPoints, checkAlike, type DecodedPoints, type ScalarColumn } from "./decoded_points";
import { checkEdits, forEachResized, movedRadius, splice, type CheckedEdits } from "./point_edits";

/// Points in slots. The slots are in no order, so that a delta touches only those of the points that it changes. Free slots have radius 0.
export interface PointStore {
  /// Is to be added to every position.
  readonly origin: readonly [number, number, number];
  /// Number of points.
  readonly count: number;
  /// Number of slots in use, free ones among them. The arrays may be longer.
  readonly slots: number;
  readonly positions: Float32Array; // 4 a slot: x, y, z relative to the origin, radius
  readonly normals: Int8Array; // 4 a slot: x, y, z of the unit normal, 1 = 127; 0
  readonly colours: Uint8Array | null; // 4 a slot: red, green, blue (sRGB), 255; null where the mesh has none
  readonly curvatures: Float32Array | null; // 2 a slot: least and largest principal curvature; null where the view does not ask for them
  readonly ranks: Uint32Array | null; // 1 a slot; null where the view does not ask for them
  readonly directions: Float32Array | null; // 3 a slot: unit tangent of the least principal curvature; null where the view does not ask
  readonly scalars: readonly ScalarColumn[]; // 1 a slot each; none where the view does not ask for them, or the mesh has none
  /// Of the session: where the surface turns by more degrees, it has a crease.
  readonly creaseDegrees: number;
  /// The points are of a surface, whose normals point outwards. Others have no outer side, and no creases are looked for.
  readonly isSurface: boolean;
  /// Returns the changes since the last call. One reader may call it.
  takeChanges(): PointChanges;
}

/// The angle of creases of most sessions.
export const usualCreaseDegrees = 40;

/// How many points a frame has added, removed, and resized.
export interface PointDifference {
  added: number;
  removed: number;
  resized: number;
}

const fewSlots = 4096; // a store of at most so many slots keeps its free ones

/// Applies frames to its points. Throws DATA_LOSS for a frame that does not fit, and then changes nothing.
export class StreamedPoints implements PointStore {
  origin: [number, number, number] = [0, 0, 0];
  count = 0;
  slots = 0;
  positions = new Float32Array(0);
  normals = new Int8Array(0);
  colours: Uint8Array | null = null;
  curvatures: Float32Array | null = null;
  ranks: Uint32Array | null = null;
  directions: Float32Array | null = null;
  scalars: readonly ScalarColumn[] = [];
  creaseDegrees = usualCreaseDegrees;
  readonly isSurface = true;

  private list = new Uint32Array(0); // the slots of the points in the order of the stream, `count` of them
  private spare = new Uint32Array(0); // the memory of the list before, for the next one
  private free: number[] = []; // slots below `slots` without a point
  private readonly changed = new ChangedSlots();

  takeChanges(): PointChanges {
    return this.changed.take(this.slots);
  }

  /// Lists the slots of the points in the order of the stream, which is that along the curve.
  order(): Uint32Array {
    return this.list.subarray(0, this.count);
  }

  /// Applies a key frame: the store has the points of `blocks` after it.
  replace(blocks: readonly DecodedPoints[]): PointDifference {
    const parts = blocks.filter((block) => block.count > 0);
    checkAlike(parts);
    const added = parts.reduce((sum, block) => sum + block.count, 0);
    const removed = this.count;
    this.origin = parts[0]?.origin ?? [0, 0, 0];
    this.makeColumns(added, parts[0]);
    let slot = 0;
    for (const part of parts) {
      this.positions.set(part.positions, 4 * slot);
      this.normals.set(part.normals, 4 * slot);
      if (part.colours !== null) this.colours?.set(part.colours, 4 * slot);
      if (part.curvatures !== null) this.curvatures?.set(part.curvatures, 2 * slot);
      if (part.ranks !== null) this.ranks?.set(part.ranks, slot);
      if (part.directions !== null) this.directions?.set(part.directions, 3 * slot);
      this.scalars.forEach(({ values }, s) => values.set(part.scalars[s]!.values, slot));
      slot += part.count;
    }
    this.list = counted(added);
    this.free = [];
    this.count = this.slots = added;
    this.changed.addAll();
    return { added, removed, resized: 0 };
  }

  /// Applies a delta, whose new points are those of `blocks`. The store has `expected` points after it.
  edit(edits: PointEdits, blocks: readonly DecodedPoints[], expected: number): PointDifference {
    const parts = blocks.filter((block) => block.count > 0);
    checkAlike(this.count > 0 ? [this, ...parts] : parts);
    const checked = checkEdits(
      edits,
      this.count,
      parts.reduce((sum, block) => sum + block.count, 0),
    );
    if (checked.size !== expected) throw badPoints(`${checked.size} after a frame, not ${expected}`);
    if (this.count === 0) {
      this.replace(parts);
    } else {
      this.remove(checked.removed);
      this.insert(checked, parts);
    }
    forEachResized(edits, (index, step) => {
      const slot = this.list[index]!;
      this.positions[4 * slot + 3] = movedRadius(this.positions[4 * slot + 3]!, step, edits.radiusMax);
      this.changed.add(slot);
    });
    if (this.slots > fewSlots && this.slots > 2 * this.count) this.compact();
    return { added: checked.added.length, removed: checked.removed.length, resized: edits.resized.length };
  }

  private remove(removed: Uint32Array): void {
    for (const index of removed) {
      const slot = this.list[index]!;
      this.positions[4 * slot + 3] = 0;
      this.free.push(slot);
      this.changed.add(slot);
    }
  }

  private insert(edits: CheckedEdits, parts: readonly DecodedPoints[]): void {
    if (this.spare.length < edits.size) this.spare = new Uint32Array(edits.size + (edits.size >> 2));
    splice(this.list, edits, this.count, this.spare);
    this.reserve(this.slots + Math.max(0, edits.added.length - this.free.length));
    let next = 0;
    for (const part of parts) {
      for (let i = 0; i < part.count; ++i) {
        const slot = this.free.pop() ?? this.slots++;
        this.spare[edits.added[next++]!] = slot;
        this.write(slot, part, i);
        this.changed.add(slot);
      }
    }
    [this.list, this.spare] = [this.spare, this.list];
    this.count = edits.size;
  }

  private write(slot: number, from: DecodedPoints, i: number): void {
    for (let k = 0; k < 4; ++k) {
      this.positions[4 * slot + k] = from.positions[4 * i + k]!;
      this.normals[4 * slot + k] = from.normals[4 * i + k]!;
      if (this.colours !== null) this.colours[4 * slot + k] = from.colours![4 * i + k]!;
    }
    if (this.curvatures !== null) this.curvatures.set(from.curvatures!.subarray(2 * i, 2 * i + 2), 2 * slot);
    if (this.ranks !== null) this.ranks[slot] = from.ranks![i]!;
    if (this.directions !== null) this.directions.set(from.directions!.subarray(3 * i, 3 * i + 3), 3 * slot);
    for (let s = 0; s < this.scalars.length; ++s) this.scalars[s]!.values[slot] = from.scalars[s]!.values[i]!;
  }

  /// Makes empty columns of so many slots: those that `like` has.
  private makeColumns(slots: number, like: Columns | undefined): void {
    this.positions = new Float32Array(4 * slots);
    this.normals = new Int8Array(4 * slots);
    this.colours = like?.colours ? new Uint8Array(4 * slots) : null;
    this.curvatures = like?.curvatures ? new Float32Array(2 * slots) : null;
    this.ranks = like?.ranks ? new Uint32Array(slots) : null;
    this.directions = like?.directions ? new Float32Array(3 * slots) : null;
    this.scalars = like?.scalars.map(({ name }) => ({ name, values: new Float32Array(slots) })) ?? [];
  }

  private reserve(slots: number): void {
    const capacity = this.positions.length / 4;
    if (slots <= capacity) return;
    const old = this.columns();
    this.makeColumns(Math.max(slots, capacity + (capacity >> 1)), old);
    this.positions.set(old.positions);
    this.normals.set(old.normals);
    if (old.colours !== null) this.colours?.set(old.colours);
    if (old.curvatures !== null) this.curvatures?.set(old.curvatures);
    if (old.ranks !== null) this.ranks?.set(old.ranks);
    if (old.directions !== null) this.directions?.set(old.directions);
    this.scalars.forEach(({ values }, s) => values.set(old.scalars[s]!.values));
    this.changed.addAll();
  }

  /// Gives free slots back: moves the points to the first slots, in the order of the stream.
  private compact(): void {
    const old = { count: this.count, origin: this.origin, ...this.columns() };
    this.makeColumns(this.count, old);
    this.order().forEach((slot, i) => this.write(i, old, slot));
    this.list = counted(this.count);
    this.free = [];
    this.slots = this.count;
    this.changed.addAll();
  }

  private columns(): Columns {
    return {
      positions: this.positions,
      normals: this.normals,
      colours: this.colours,
      curvatures: this.curvatures,
      ranks: this.ranks,
      directions: this.directions,
      scalars: this.scalars,
    };
  }
}

/// Makes the array 0, 1, 2 ... of `count` numbers.
function counted(count: number): Uint32Array<ArrayBuffer> {
  const numbers = new Uint32Array(count);
  for (let i = 0; i < count; ++i) numbers[i] = i;
  return numbers;
}

type Columns = Pick<PointStore, "positions" | "normals" | "colours" | "curvatures" | "ranks" | "directions" | "scalars">;
