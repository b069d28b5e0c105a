import { readFileSync } from "node:fs";

import { expect, it } from "vitest";

import * as protocol from "../../../../client/web/src/stream/protocol";

const numbers = JSON.parse(readFileSync(new URL("../../protocol.json", import.meta.url), "utf8")) as Record<string, number>;

it.each(Object.entries(protocol))("%s is the number of the API", (name, value) => {
  expect(value).toBe(numbers[name.replace(/[A-Z]/g, "_$&").toUpperCase()]);
});
