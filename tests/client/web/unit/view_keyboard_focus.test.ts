import { expect, test } from "vitest";

import { takesKeys } from "../../../../client/web/src/view/keyboard_focus";

/// A target whose nearest field is this one.
const within = (tagName: string, type = "") => ({ closest: () => ({ tagName, type }) }) as unknown as EventTarget;

test.each(["text", "number", "password", "search", "range", ""])("an input of type %s takes keys", (type) => {
  expect(takesKeys(within("INPUT", type))).toBe(true);
});

test("so do other fields", () => {
  for (const tag of ["TEXTAREA", "SELECT", "DIV"]) expect(takesKeys(within(tag))).toBe(true);
});

test("what is only pressed leaves them to the picture", () => {
  for (const type of ["checkbox", "button", "file", "color"]) expect(takesKeys(within("INPUT", type))).toBe(false);
  expect(takesKeys({ closest: () => null } as unknown as EventTarget)).toBe(false);
  expect(takesKeys({} as EventTarget)).toBe(false); // the window
  expect(takesKeys(null)).toBe(false);
});
