// SPDX-License-Identifier: Apache-2.0
// Strokes of the brush: dabs of paint, up to the number that the server takes.

import { distance } from "../view/vector";
import { maxDabs, type Dab, type Settings } from "./settings";

const spacing = 0.5; // between the dabs of a stroke, in radii: paint of one stroke does not pile up
const noPaint = 1; // the factor that takes paint away

/// Adds dabs to Settings.dabs, and removes them.
export class Brush {
  private stroke: number | null = null; // number of the stroke under way
  private hasWarned = false;
  private seen: { from: readonly Dab[]; copy: readonly Dab[] } = { from: [], copy: [] };

  constructor(
    private readonly settings: Settings,
    private readonly notice: (text: string) => void,
  ) {}

  /// Paints with the pointer at `centre`. `done`: the pointer was lifted there. Returns whether a dab was added.
  paint(centre: Dab["centre"], radius: number, done: boolean): boolean {
    const { dabs } = this.settings;
    this.stroke ??= 1 + (dabs.at(-1)?.stroke ?? -1);
    const before = dabs.at(-1);
    const isNear = before !== undefined && before.stroke === this.stroke && distance(before.centre, centre) < spacing * radius;
    const adds = !isNear && dabs.length < maxDabs;
    const factor = this.settings.eraser ? noPaint : this.settings.brushFactor;
    if (adds) dabs.push(this.likeStroke({ centre, radius, factor, stroke: this.stroke }));
    else if (!isNear && !this.hasWarned) {
      this.hasWarned = true;
      this.notice(`There are ${maxDabs.toLocaleString("en")} dabs at most: undo or clear strokes to go on.`);
    }
    if (done) {
      this.stroke = null;
      this.hasWarned = false;
    }
    return adds;
  }

  /// Returns the dabs, the same array until they change.
  trace(): readonly Dab[] {
    const { dabs } = this.settings;
    if (this.seen.from !== dabs || this.seen.copy.length !== dabs.length) this.seen = { from: dabs, copy: [...dabs] };
    return this.seen.copy;
  }

  /// Removes the last stroke.
  undo(): void {
    const last = this.settings.dabs.at(-1)?.stroke;
    this.settings.dabs = this.settings.dabs.filter(({ stroke }) => stroke !== last);
  }

  clear(): void {
    this.settings.dabs = [];
  }

  /// Dabs of a stroke are alike, also where the settings change under way.
  private likeStroke(dab: Dab): Dab {
    const before = this.settings.dabs.at(-1);
    return before?.stroke === dab.stroke ? { ...dab, radius: before.radius, factor: before.factor } : dab;
  }
}
