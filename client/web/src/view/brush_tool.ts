// SPDX-License-Identifier: Apache-2.0
// The brush of the pointer: strokes over the surface.

import type { PointerTool } from "./camera_controls";
import type { Vec } from "./types";
import { distance } from "./vector";

const step = 0.25; // radii that the pointer moves between two dabs

/// Paints where the pointer is pressed. Calls `onPaint` for each place, and once more, with true, where the stroke ends.
export class BrushTool implements PointerTool {
  /// In units; null: there is no brush.
  radius: number | null = null;
  private last: Vec | null = null; // of the stroke under way

  constructor(
    private readonly pick: (x: number, y: number) => Vec | null,
    private readonly onPaint: (centre: Vec, done: boolean) => void,
  ) {}

  press(x: number, y: number): void {
    this.drag(x, y);
  }

  drag(x: number, y: number): void {
    const centre = this.pick(x, y);
    if (centre === null || this.radius === null) return;
    if (this.last !== null && distance(this.last, centre) < step * this.radius) return;
    this.last = centre;
    this.onPaint(centre, false);
  }

  release(): void {
    const { last } = this;
    this.last = null;
    if (last !== null) this.onPaint(last, true);
  }
}
