// SPDX-License-Identifier: Apache-2.0
// Remembers which slots of a store have changed. Slots are noted in groups: few large transfers are faster than many small ones.

const slotsPerGroup = 32;

/// The slots that have changed since takeChanges() was called last.
export interface PointChanges {
  /// All slots have changed, or the arrays were replaced by larger ones.
  all: boolean;
  /// Pairs [begin, end) of slots, ascending and apart. Empty where `all` is true.
  ranges: number[];
}

/// Slots are numbered from 0.
export class ChangedSlots {
  private groups = new Uint8Array(0); // 1: some slot of the group has changed
  private everything = true;

  add(slot: number): void {
    const group = Math.floor(slot / slotsPerGroup);
    if (group >= this.groups.length) {
      const larger = new Uint8Array(2 * group + 64);
      larger.set(this.groups);
      this.groups = larger;
    }
    this.groups[group] = 1;
  }

  addAll(): void {
    this.everything = true;
  }

  /// Returns the changes among the first `slots` slots, and forgets them.
  take(slots: number): PointChanges {
    const changes: PointChanges = { all: this.everything, ranges: this.everything ? [] : this.ranges(slots) };
    this.everything = false;
    this.groups.fill(0);
    return changes;
  }

  private ranges(slots: number): number[] {
    const ranges: number[] = [];
    const end = Math.min(this.groups.length, Math.ceil(slots / slotsPerGroup));
    for (let group = this.groups.indexOf(1); group >= 0 && group < end; group = this.groups.indexOf(1, group)) {
      ranges.push(group * slotsPerGroup);
      while (group < end && this.groups[group] === 1) ++group;
      ranges.push(Math.min(group * slotsPerGroup, slots));
    }
    return ranges;
  }
}
