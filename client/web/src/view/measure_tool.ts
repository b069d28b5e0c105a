// The line between two points that a user clicks on the surface.

import { measureLines } from "./overlay_shapes";
import type { OverlayLine } from "./overlay_lines";
import type { Vec } from "./types";
import { distance } from "./vector";

/// Two clicks make a line, which stays until the next click or until the tool is switched off.
export class MeasureTool {
  private isOn = false;
  private points: Vec[] = []; // two at most

  /// `onLength`: the line is there, of this length in units; null: it is no longer.
  constructor(private readonly onLength: (length: number | null) => void) {}

  /// Whether the line has one end, and follows the pointer with the other.
  get followsPointer(): boolean {
    return this.isOn && this.points.length === 1;
  }

  /// Switches the tool on or off. False where it was so already.
  setOn(on: boolean): boolean {
    if (on === this.isOn) return false;
    this.isOn = on;
    this.clear();
    return true;
  }

  /// Forgets what was clicked.
  clear(): void {
    this.points = [];
    this.onLength(null);
  }

  /// Takes the point that `pick` finds under a click, where the tool is on. False where that changes nothing.
  click(pick: () => Vec | null): boolean {
    const point = this.isOn ? pick() : null;
    if (point === null) return false;
    if (this.points.length === 2) this.clear();
    this.points.push(point);
    const [a, b] = this.points;
    if (a && b) this.onLength(distance(a, b));
    return true;
  }

  /// The line, as far as it is there. `hovered`: the point under the pointer.
  lines(hovered: Vec | null): OverlayLine[] {
    const [a, b] = this.points;
    return this.isOn && a ? measureLines(a, b ?? hovered ?? a) : [];
  }
}
