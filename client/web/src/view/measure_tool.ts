// SPDX-License-Identifier: Apache-2.0
// The figure of points that a user clicks on the surface, to measure it.

import { measure, type Measured, type MeasureKind } from "./measures";
import { measureLines } from "./overlay_shapes";
import type { OverlayLine } from "./overlay_lines";
import type { Vec } from "./types";

const clicksOf: Record<MeasureKind, number> = { distance: 2, angle: 3, area: Infinity };

/// Makes a figure of clicks, which stays until the next click or until the tool is switched off. A polygon is complete with a click on
/// its first point.
export class MeasureTool {
  private kind: MeasureKind | null = null;
  private points: Vec[] = [];
  private isComplete = false;

  /// `onMeasure` is called with each result, and with null once there is none.
  constructor(private readonly onMeasure: (measured: Measured | null) => void) {}

  get isOn(): boolean {
    return this.kind !== null;
  }

  /// Whether the figure has a point, and follows the pointer with the next one.
  get followsPointer(): boolean {
    return this.points.length > 0 && !this.isComplete;
  }

  /// Switches the tool on, or, with null, off. Returns whether that has changed anything.
  setKind(kind: MeasureKind | null): boolean {
    if (kind === this.kind) return false;
    this.kind = kind;
    this.clear();
    return true;
  }

  /// Forgets what was clicked.
  clear(): void {
    this.points = [];
    this.isComplete = false;
    this.onMeasure(null);
  }

  /// Takes a point that was clicked, where the tool is on. `isAt` says whether the click was at another point, too. Returns whether that
  /// has changed anything.
  click(point: Vec, isAt: (other: Vec) => boolean): boolean {
    const { kind } = this;
    if (kind === null) return false;
    if (this.isComplete) this.clear();
    if (kind === "area" && this.points.length >= 3 && isAt(this.points[0]!)) this.isComplete = true;
    else this.points.push(point);
    this.isComplete ||= this.points.length >= clicksOf[kind];
    const measured = measure(kind, this.points);
    if (measured !== null) this.onMeasure(measured);
    return true;
  }

  /// Returns the figure as far as it is there. `hovered`: the point under the pointer, which is its next one.
  lines(hovered: Vec | null): OverlayLine[] {
    const next = this.followsPointer && hovered !== null ? [hovered] : [];
    return measureLines([...this.points, ...next], this.kind === "area");
  }
}
