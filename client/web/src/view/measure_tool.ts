// The line between two points that a user clicks on the surface.

import { measureLines } from "./overlay_shapes";
import type { OverlayLine } from "./overlay_lines";
import type { Vec } from "./types";
import { distance } from "./vector";

/// Makes a line of two clicks, which stays until the next click or until the tool is switched off.
export class MeasureTool {
  isOn = false;
  private points: Vec[] = []; // two at most

  /// `onLength` is called with the length of a line in units once it is complete, and with null once there is none.
  constructor(private readonly onLength: (length: number | null) => void) {}

  /// Whether the line has one end, and follows the pointer with the other.
  get followsPointer(): boolean {
    return this.isOn && this.points.length === 1;
  }

  /// Switches the tool on or off. Returns whether that has changed anything.
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

  /// Takes a point that was clicked, where the tool is on. Returns whether that has changed anything.
  click(point: Vec): boolean {
    if (!this.isOn) return false;
    if (this.points.length === 2) this.clear();
    this.points.push(point);
    const [a, b] = this.points;
    if (a && b) this.onLength(distance(a, b));
    return true;
  }

  /// Returns the line as far as it is there. `hovered`: the point under the pointer, which is its end until the second click.
  lines(hovered: Vec | null): OverlayLine[] {
    const [a, b] = this.points;
    return this.isOn && a ? measureLines(a, b ?? hovered ?? a) : [];
  }
}
