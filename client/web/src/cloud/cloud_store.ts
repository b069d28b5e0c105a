// SPDX-License-Identifier: Apache-2.0
// The points of a file as a store, which the viewer draws as it does those of a stream.

import { ChangedSlots, type PointChanges } from "../stream/changed_slots";
import { usualCreaseDegrees, type PointStore } from "../stream/point_store";

/// The columns of a cloud, each as in PointStore. Every so many points are an even part of them.
export interface Cloud {
  count: number;
  origin: [number, number, number];
  positions: Float32Array<ArrayBuffer>;
  normals: Int8Array<ArrayBuffer>;
  colours: Uint8Array<ArrayBuffer> | null;
  /// Corners of the box around all points, in the file's own frame; a box of some size where they are all at one place.
  min: [number, number, number];
  max: [number, number, number];
  /// What the user is to know, as sentences.
  notices: string[];
}

/// Points that never change. Each is in the slot of its number.
export class CloudStore implements PointStore {
  readonly origin: readonly [number, number, number];
  readonly count: number;
  readonly slots: number;
  readonly positions: Float32Array;
  readonly normals: Int8Array;
  readonly colours: Uint8Array | null;
  readonly curvatures = null;
  readonly ranks = null;
  readonly directions = null;
  readonly scalars = [];
  readonly creaseDegrees = usualCreaseDegrees;
  readonly isSurface = false;
  private readonly changed = new ChangedSlots(); // all, until they are taken

  constructor({ count, origin, positions, normals, colours }: Cloud) {
    this.count = this.slots = count;
    this.origin = origin;
    this.positions = positions;
    this.normals = normals;
    this.colours = colours;
  }

  takeChanges(): PointChanges {
    return this.changed.take(this.slots);
  }

  /// Lists the slots of the points.
  order(): Uint32Array {
    return Uint32Array.from({ length: this.count }, (_, slot) => slot);
  }
}
