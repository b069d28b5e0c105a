// SPDX-License-Identifier: Apache-2.0
// Sliders of lil-gui for those who use keys, or have the page read out.

/// What is needed of a number's controller in lil-gui.
export interface NumberControl {
  domElement: HTMLElement;
  getValue(): unknown;
  setValue(value: number): unknown;
  updateDisplay(): unknown;
}

/// The range of a number; `step`: of one press of an arrow.
export interface Steps {
  min: number;
  max: number;
  step: number;
}

/// Returns the value that a key moves a slider to; null for keys that do nothing there.
export function moved(key: string, isFast: boolean, value: number, { min, max, step }: Steps): number | null {
  const by = (steps: number): number => {
    const there = min + step * Math.round((value - min) / step + steps); // on the grid of steps
    return Number(Math.min(max, Math.max(min, there)).toPrecision(12));
  };
  const steps = isFast ? 10 : 1;
  if (key === "ArrowRight" || key === "ArrowUp") return by(steps);
  if (key === "ArrowLeft" || key === "ArrowDown") return by(-steps);
  if (key === "PageUp") return by(10);
  if (key === "PageDown") return by(-10);
  if (key === "Home") return min;
  if (key === "End") return max;
  return null;
}

/// Makes the slider of a number one for keys: `move` is moved() or the like. Returns a function that tells it of the value, to be called
/// after each change.
export function makeSlider(control: NumberControl, steps: Steps, move = moved): () => void {
  const slider = control.domElement.querySelector(".slider")!;
  const name = control.domElement.querySelector(".name")!;
  const attributes = {
    role: "slider",
    tabindex: "0",
    "aria-labelledby": name.id,
    "aria-valuemin": String(steps.min),
    "aria-valuemax": String(steps.max),
  };
  for (const [attribute, value] of Object.entries(attributes)) slider.setAttribute(attribute, value);
  slider.addEventListener("keydown", (event) => {
    const { key, shiftKey } = event as KeyboardEvent;
    const to = move(key, shiftKey, Number(control.getValue()), steps);
    if (to === null) return;
    event.preventDefault();
    control.setValue(to);
  });
  return () => slider.setAttribute("aria-valuenow", String(control.getValue()));
}
