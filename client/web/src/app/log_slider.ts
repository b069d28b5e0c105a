// SPDX-License-Identifier: Apache-2.0
// Sliders of lil-gui on a logarithmic scale: equal ways along them are equal factors.

import type { NumberControl, Steps } from "./panel_access";
import { moved } from "./panel_access";

const stepsPerDecade = 20; // of the arrow keys
const digits = 2; // of the values, which are to be read easily

/// Returns the round value at a place of the slider, from 0 to 1: on the grid of steps, unless it is an end.
export function valueAt(place: number, { min, max, step }: Steps): number {
  if (place <= 0) return min;
  if (place >= 1) return max;
  const round = Number((min * (max / min) ** place).toPrecision(digits));
  return Math.min(max, Math.max(min, step * Math.round(round / step)));
}

/// Returns the place of a value, from 0 to 1.
export function placeOf(value: number, { min, max }: Steps): number {
  return Math.log(Math.max(value, min) / min) / Math.log(max / min);
}

/// Returns the value that a key moves the slider to, as moved() does. Where steps are wider than the scale's, it goes on to the next one.
export function movedByFactors(key: string, isFast: boolean, value: number, steps: Steps): number | null {
  const places: Steps = { min: 0, max: 1, step: 1 / (stepsPerDecade * Math.log10(steps.max / steps.min)) };
  let place = placeOf(value, steps);
  for (;;) {
    const to = moved(key, isFast, place, places);
    if (to === null) return null;
    const there = valueAt(to, steps);
    if (there !== value || to === place) return there;
    place = to;
  }
}

/// Has the slider of a number be logarithmic for the pointer, and look like it.
export function makeLogarithmic(control: NumberControl, steps: Steps): void {
  const slider = control.domElement.querySelector<HTMLElement>(".slider")!;
  const fill = slider.querySelector<HTMLElement>(".fill")!;
  const show = control.updateDisplay.bind(control);
  control.updateDisplay = () => {
    const shown = show();
    fill.style.width = `${100 * Math.min(1, placeOf(Number(control.getValue()), steps))}%`;
    return shown;
  };
  control.updateDisplay();
  // Instead of lil-gui's own, which are even.
  for (const kind of ["mousedown", "touchstart"]) {
    slider.addEventListener(kind, (event) => event.stopImmediatePropagation(), { capture: true });
  }
  const follow = (event: PointerEvent): void => {
    const { left, width } = slider.getBoundingClientRect();
    control.setValue(valueAt((event.clientX - left) / width, steps));
  };
  let isHeld = false;
  slider.style.touchAction = "pan-y"; // a finger that goes up or down scrolls the panel
  slider.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    isHeld = true;
    slider.setPointerCapture(event.pointerId);
    if (event.pointerType === "mouse") follow(event); // a finger may be about to scroll
  });
  slider.addEventListener("pointermove", (event) => isHeld && follow(event));
  slider.addEventListener("pointerup", (event) => {
    if (isHeld) follow(event);
    isHeld = false;
  });
  slider.addEventListener("pointercancel", () => (isHeld = false));
}
