// Where the discs of a store end, as its points change.

import { ChangedSlots, type PointChanges } from "../stream/changed_slots";
import type { PointStore } from "../stream/point_store";
import { findDiscEnds } from "./disc_ends";
import type { EndsFinder, FoundEnds } from "./ends_finder";

/// Numbers of a slot: two planes, as in DiscEnds.
const size = 8;
const idleShare = 3; // pauses between two searches, in times that a search takes

/// Has the ends of all discs found again after changes, one search at a time. Until then, discs that are new have none, and
/// others those that they had.
export class StoreEnds {
  private planesNow: Float32Array | null = null; // of all slots; null: there are no ends
  /// The positions that the planes are for. They say nothing of slots without ends.
  private positions = new Float32Array(0);
  private count = 0; // discs with ends
  private readonly changed = new ChangedSlots();
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

  /// 8 a slot, as in DiscEnds; null where no disc ends.
  get planes(): Float32Array | null {
    return this.planesNow;
  }

  /// Returns the slots whose planes have changed since the last call, where these are still in the same array: pairs [begin,
  /// end).
  takeChanges(): number[] {
    return this.changed.take(this.store.slots).ranges;
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
    const { positions, normals, slots } = this.store;
    this.pause();
    this.isDue = false;
    this.take({ ends: findDiscEnds(positions, normals, slots, this.scale), positions: positions.slice(0, 4 * slots) });
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

  /// Drops the planes of slots [begin, end) that have other points now.
  private forgetOthers(begin: number, end: number): void {
    const planes = this.planesNow;
    if (planes === null) return;
    for (let slot = begin; slot < Math.min(end, planes.length / size); ++slot) {
      if (!hasEnd(planes, slot) || this.isSame(this.positions, slot)) continue;
      planes.fill(0, size * slot, size * (slot + 1));
      this.changed.add(slot);
      --this.count;
    }
    this.resize();
  }

  /// Whether a slot's point is where it was.
  private isSame(positions: Float32Array, slot: number): boolean {
    const now = this.store.positions;
    for (let i = 4 * slot; i < 4 * slot + 3; ++i) if (positions[i] !== now[i]) return false;
    return now[4 * slot + 3]! > 0;
  }

  /// Has an array for all slots where there are ends.
  private resize(): void {
    const length = (size * this.store.positions.length) / 4;
    const old = this.planesNow;
    if (this.count === 0) this.planesNow = null;
    else if (old?.length !== length) {
      this.planesNow = new Float32Array(length);
      if (old) this.planesNow.set(old.subarray(0, length));
    }
  }

  /// Takes the ends of those points that are still there. Returns whether planes have changed.
  private take({ ends, positions }: FoundEnds): boolean {
    const old = this.planesNow;
    this.positions = positions;
    if (old === null && ends.slots.length === 0) return false;
    const planes = new Float32Array((size * this.store.positions.length) / 4);
    this.count = 0;
    ends.slots.forEach((slot, i) => {
      if (slot >= this.store.slots || !this.isSame(positions, slot)) return;
      planes.set(ends.planes.subarray(size * i, size * (i + 1)), size * slot);
      ++this.count;
    });
    if (this.count === 0 || old?.length !== planes.length) {
      this.planesNow = this.count > 0 ? planes : null;
      return old !== null || this.count > 0;
    }
    return this.copyDifferences(planes, old);
  }

  private copyDifferences(from: Float32Array, to: Float32Array): boolean {
    let isOther = false;
    for (let slot = 0; slot < this.store.slots; ++slot) {
      let i = size * slot;
      const end = i + size;
      while (i < end && from[i] === to[i]) ++i;
      if (i === end) continue;
      to.set(from.subarray(end - size, end), end - size);
      this.changed.add(slot);
      isOther = true;
    }
    return isOther;
  }
}

function hasEnd(planes: Float32Array, slot: number): boolean {
  for (let i = size * slot; i < size * (slot + 1); ++i) if (planes[i] !== 0) return true;
  return false;
}
