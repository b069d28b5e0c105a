// Whom a key is for.

// Inputs that make nothing of letters and arrows.
const pressed = ["button", "checkbox", "color", "file", "image", "reset", "submit"];

/// Whether keys that go to `target` are for a field or a dialog there, rather than for the picture.
export function takesKeys(target: EventTarget | null): boolean {
  const field = (target as Partial<Element> | null)?.closest?.(
    "input, textarea, select, [contenteditable]:not([contenteditable='false']), [aria-modal='true']",
  );
  if (field == null) return false;
  return !(field.tagName === "INPUT" && pressed.includes((field as HTMLInputElement).type));
}
