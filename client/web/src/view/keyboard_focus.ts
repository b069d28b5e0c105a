// SPDX-License-Identifier: Apache-2.0
// Decides whether a key is for a field or for the picture.

// Types of inputs that do not use letters and arrows.
const pressed = ["button", "checkbox", "color", "file", "image", "reset", "submit"];

/// Whether `target` is in a field, a slider or a dialog that takes the keys, so that they are not for the picture.
export function takesKeys(target: EventTarget | null): boolean {
  const field = (target as Partial<Element> | null)?.closest?.(
    "input, textarea, select, [contenteditable]:not([contenteditable='false']), [aria-modal='true'], [role='slider']",
  );
  if (field == null) return false;
  return !(field.tagName === "INPUT" && pressed.includes((field as HTMLInputElement).type));
}
