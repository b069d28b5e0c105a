// SPDX-License-Identifier: Apache-2.0
// Numbers that belong to the points of a store's slots, and are found some time after the points.

import { ChangedSlots } from "../../stream/changed_slots";

/// Numbers of all slots: zeros where nothing is known.
export class SlotValues<Values extends Float32Array | Uint8Array> {
  private valuesNow: Values | null = null;
  private count = 0; // slots with numbers
  private readonly changed = new ChangedSlots();

  /// `size`: numbers a slot.
  constructor(
    private readonly make: (length: number) => Values,
    private readonly size: number,
  ) {}

  /// null: nothing is known of any slot.
  get values(): Values | null {
    return this.valuesNow;
  }

  /// Returns the slots that have changed since the last call, where these are still in the same array: pairs [begin, end).
  takeChanges(slots: number): number[] {
    return this.changed.take(slots).ranges;
  }

  has(slot: number): boolean {
    const { valuesNow, size } = this;
    return valuesNow !== null && hasNumbers(valuesNow, size * slot, size * (slot + 1));
  }

  /// Precondition: has(slot).
  forget(slot: number): void {
    this.valuesNow?.fill(0, this.size * slot, this.size * (slot + 1));
    this.changed.add(slot);
    --this.count;
  }

  /// Has an array of `slots` slots where it has one at all.
  resize(slots: number): void {
    const { valuesNow: old, size } = this;
    if (old === null || this.count === 0) this.valuesNow = null;
    else if (old.length !== size * slots) {
      this.valuesNow = this.make(size * slots);
      this.valuesNow.set(old.subarray(0, size * slots));
    }
  }

  /// Takes the numbers of slots [0, `slots`) from an array of all; null: there are none. Returns whether they are other ones than before.
  take(next: Values | null, slots: number): boolean {
    const { valuesNow: now, size } = this;
    this.count = 0;
    if (next === null) {
      this.valuesNow = null;
      return now !== null;
    }
    let isOther = false;
    for (let slot = 0; slot < slots; ++slot) {
      const begin = size * slot;
      const end = begin + size;
      if (hasNumbers(next, begin, end)) ++this.count;
      if (now === null || now.length !== next.length) continue;
      let i = begin;
      while (i < end && next[i] === now[i]) ++i;
      if (i === end) continue;
      now.set(next.subarray(begin, end), begin);
      this.changed.add(slot);
      isOther = true;
    }
    if (this.count === 0) this.valuesNow = null;
    else if (now?.length !== next.length) this.valuesNow = next;
    return isOther || this.valuesNow !== now;
  }
}

function hasNumbers(values: Float32Array | Uint8Array, begin: number, end: number): boolean {
  for (let i = begin; i < end; ++i) if (values[i] !== 0) return true;
  return false;
}
