// Strokes of the brush: dabs of density, up to the number that the server takes.

import { distance } from "../view/vector";
import { roomForDabs } from "./sample_request";
import { maxTerms, type Dab, type Settings } from "./settings";

const spacing = 1.2; // between the dabs of a stroke, in radii: dabs overlap where they fall off

/// Adds dabs to Settings.dabs, and removes them.
export class Brush {
  private stroke: number | null = null; // number of the stroke under way
  private hasWarned = false;

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
    const adds = !isNear && roomForDabs(this.settings) > 0;
    if (adds) dabs.push({ centre, radius, factor: this.settings.brushFactor, stroke: this.stroke });
    else if (!isNear && !this.hasWarned) {
      this.hasWarned = true;
      this.notice(`A density has ${maxTerms} terms at most: undo or clear strokes to go on.`);
    }
    if (done) {
      this.stroke = null;
      this.hasWarned = false;
    }
    return adds;
  }

  /// Removes the last stroke.
  undo(): void {
    const last = this.settings.dabs.at(-1)?.stroke;
    this.settings.dabs = this.settings.dabs.filter(({ stroke }) => stroke !== last);
  }

  clear(): void {
    this.settings.dabs = [];
  }
}
