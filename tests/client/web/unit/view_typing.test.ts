import { expect, test } from "vitest";

import { isTyping } from "../../../../client/web/src/view/typing";

/// A target whose nearest field is this one.
const within = (tagName: string, type = "") => ({ closest: () => ({ tagName, type }) }) as unknown as EventTarget;

test.each(["text", "number", "password", "search", "range", ""])("an input of type %s takes keys", (type) => {
  expect(isTyping(within("INPUT", type))).toBe(true);
});

test("so do other fields", () => {
  for (const tag of ["TEXTAREA", "SELECT", "DIV"]) expect(isTyping(within(tag))).toBe(true);
});

test("what is only pressed leaves them to the picture", () => {
  for (const type of ["checkbox", "button", "file", "color"]) expect(isTyping(within("INPUT", type))).toBe(false);
  expect(isTyping({ closest: () => null } as unknown as EventTarget)).toBe(false);
  expect(isTyping({} as EventTarget)).toBe(false); // the window
  expect(isTyping(null)).toBe(false);
});
