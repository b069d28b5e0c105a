// SPDX-License-Identifier: Apache-2.0
// Where the discs of a store end, as its points change.

import type { PointChanges } from "../../stream/changed_slots";
import type { PointStore } from "../../stream/point_store";
import { findDiscEnds } from "./disc_ends";
import type { EndsFinder, FoundEnds } from "./ends_finder";
import { SlotValues } from "./slot_values";

/// Numbers of a slot, as in DiscEnds: of two planes, and of how it bends.
const [planeSize, bendSize] = [8, 8];
const idleShare = 3; // pauses between two searches, in times that a search takes

/// Has the ends of all discs found again after changes, one search at a time. Until then, discs that are new have none, and
/// others those that they had.
export class StoreEnds {
  private readonly planesNow = new SlotValues((length) => new Float32Array(length), planeSize);
  private readonly bendsNow = new SlotValues((length) => new Uint8Array(length), bendSize);
  /// The positions that they are for. They say nothing of slots without numbers.
  private positions = new Float32Array(0);
  private scale = 1;
  private isDue = true; // something has changed since the last search began
  private search = 0; // the number of the search that is going on; 0: none
  private lastSearch = 0;
  private waiting: ReturnType<typeof setTimeout> | undefined;
  private isBroken = false; // the finder has failed

  /// `onFound` is called when ends are other ones than before.
  constructor(
    private readonly store: PointStore,
    private readonly finder: EndsFinder,
    private readonly onFound: () => void,
  ) {}

  /// 8 a slot, as in DiscEnds; null where no disc ends at a crease.
  get planes(): Float32Array | null {
    return this.planesNow.values;
  }

  /// 8 a slot, as in DiscEnds; null where nothing is known.
  get bends(): Uint8Array | null {
    return this.bendsNow.values;
  }

  /// Returns the slots whose planes, or bends, have changed since the last call, where these are still in the same array: pairs [begin,
  /// end).
  takeChanges(of: "planes" | "bends"): number[] {
    return (of === "planes" ? this.planesNow : this.bendsNow).takeChanges(this.store.slots);
  }

  /// Takes changes of the store, and the factor of its radii.
  refresh(changes: PointChanges, scale: number): void {
    if (changes.all || changes.ranges.length > 0 || scale !== this.scale) this.isDue = true;
    this.scale = scale;
    if (changes.all) this.forgetOthers(0, this.store.slots);
    for (let i = 0; i < changes.ranges.length; i += 2) this.forgetOthers(changes.ranges[i]!, changes.ranges[i + 1]!);
    if (this.waiting === undefined) this.goOn();
  }

  /// Finds them now, if they are not known.
  complete(): void {
    if (!this.isDue && this.search === 0) return;
    const { positions, normals, slots, creaseDegrees } = this.store;
    this.pause();
    this.isDue = false;
    this.take({
      ends: findDiscEnds(positions, normals, slots, this.scale, creaseDegrees),
      positions: positions.slice(0, 4 * slots),
    });
  }

  /// Searches no more until the next refresh().
  pause(): void {
    if (this.search !== 0) this.isDue = true;
    this.search = 0;
    clearTimeout(this.waiting);
    this.waiting = undefined;
  }

  private async start(): Promise<void> {
    const { store, scale } = this;
    const search = (this.search = ++this.lastSearch);
    this.isDue = false;
    const begin = performance.now();
    const found = await this.finder.find({
      positions: store.positions.slice(0, 4 * store.slots),
      normals: store.normals.slice(0, 4 * store.slots),
      scale,
      creaseDegrees: store.creaseDegrees,
    });
    if (this.search !== search) return;
    this.search = 0;
    // A picture that moves needs the processor, too.
    this.waiting = setTimeout(() => this.goOn(), idleShare * (performance.now() - begin));
    if (found === null) this.isBroken = true;
    else if (this.take(found)) this.onFound();
  }

  private goOn(): void {
    this.waiting = undefined;
    if (this.isDue && this.search === 0 && !this.isBroken) void this.start();
  }

  private get columns(): [typeof this.planesNow, typeof this.bendsNow] {
    return [this.planesNow, this.bendsNow];
  }

  /// Drops the numbers of slots [begin, end) that have other points now.
  private forgetOthers(begin: number, end: number): void {
    const last = Math.min(end, this.positions.length / 4);
    for (let slot = begin; slot < last; ++slot) {
      if (this.isSame(this.positions, slot)) continue;
      for (const column of this.columns) if (column.has(slot)) column.forget(slot);
    }
    for (const column of this.columns) column.resize(this.store.positions.length / 4);
  }

  /// Whether a slot's point is where it was.
  private isSame(positions: Float32Array, slot: number): boolean {
    const now = this.store.positions;
    for (let i = 4 * slot; i < 4 * slot + 3; ++i) if (positions[i] !== now[i]) return false;
    return now[4 * slot + 3]! > 0;
  }

  /// Takes the ends of those points that are still there. Returns whether any have changed.
  private take({ ends, positions }: FoundEnds): boolean {
    const { slots } = this.store;
    const capacity = this.store.positions.length / 4;
    this.positions = positions;
    const planes = ends.slots.length > 0 ? new Float32Array(planeSize * capacity) : null;
    ends.slots.forEach((slot, i) => {
      if (slot >= slots || !this.isSame(positions, slot)) return;
      planes?.set(ends.planes.subarray(planeSize * i, planeSize * (i + 1)), planeSize * slot);
    });
    const found = Math.min(slots, positions.length / 4);
    const bends = new Uint8Array(bendSize * capacity);
    bends.set(ends.bends.subarray(0, bendSize * found));
    for (let slot = 0; slot < found; ++slot)
      if (!this.isSame(positions, slot)) bends.fill(0, bendSize * slot, bendSize * (slot + 1));
    const areOthers = [this.planesNow.take(planes, slots), this.bendsNow.take(bends, slots)];
    return areOthers.includes(true);
  }
}
