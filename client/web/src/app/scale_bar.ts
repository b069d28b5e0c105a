// SPDX-License-Identifier: Apache-2.0
// A bar that says how large what the camera looks at is.

import type { CameraState } from "../view";
import { halfHeight } from "../view/camera_math";
import { element } from "./elements";
import { length, type Unit } from "./format";

const longest = 120; // CSS pixels

/// Returns the longest bar of 1, 2 or 5 times a power of ten that is not too long.
export function barOf(unitsPerPixel: number): { units: number; pixels: number } {
  const most = longest * unitsPerPixel;
  const power = 10 ** Math.floor(Math.log10(most));
  const units = power * [5, 2, 1].find((digit) => digit * power <= most * (1 + 1e-9))!;
  return { units, pixels: units / unitsPerPixel };
}

/// Returns the units that a pixel stands for at the distance of the camera's target. `height`: of the picture, in pixels.
export function unitsPerPixel(camera: CameraState, height: number): number {
  return (2 * halfHeight(camera)) / Math.max(1, height);
}

/// Shows the bar. What is nearer to the eye than the camera's target is larger, unless the camera is orthographic.
export class ScaleBar {
  private readonly bar = element("div");
  private readonly text = element("span");
  private units = 1;
  private unitNow: Unit = "none";
  private readonly root = element(
    "div",
    { class: "scale", title: "At the distance of what the camera turns about, in units of the file" },
    [this.bar, this.text],
  );

  constructor(parent: HTMLElement) {
    this.root.hidden = true;
    parent.append(this.root);
  }

  set unit(unit: Unit) {
    this.unitNow = unit;
    this.text.textContent = length(this.units, unit);
  }

  /// `height`: of the picture, in CSS pixels.
  show(camera: CameraState, height: number): void {
    const { units, pixels } = barOf(unitsPerPixel(camera, height));
    this.root.hidden = false;
    this.bar.style.width = `${pixels.toFixed(1)}px`;
    this.units = units;
    this.text.textContent = length(units, this.unitNow);
  }
}
