// SPDX-License-Identifier: Apache-2.0
// What the attributes of an element ask for: an address as the viewer has it, and settings that stand above those in it.

import type { Settings } from "../app/settings";
import { readState } from "../app/url_state";
import { socketUrl } from "../stream";
import type { CameraState } from "../view";

/// The attributes that an element observes.
export const observedAttributes = ["src", "token", "session", "points", "mode", "colouring", "background"] as const;
type AttributeName = (typeof observedAttributes)[number];

/// Attributes that are settings of the viewer, by the same names.
const settingNames = ["points", "mode", "colouring", "background"] as const satisfies readonly (AttributeName & keyof Settings)[];
// What a visitor does with the viewer's panel: an element has none.
const withoutTools: Partial<Settings> = {
  split: false,
  frozen: false,
  brush: false,
  eraser: false,
  wireframe: false,
  measuring: false,
  marking: false,
};

/// Returns an attribute's text; null where it is not there.
export type Attributes = (name: AttributeName) => string | null;

/// Who is asked for which session. Another one is another stream.
export interface SessionSource {
  url: string; // of the server's socket
  token: string | undefined;
  sessionId: string | null; // null: the first that is ready
}

/// The parameters after # in `src`.
function parametersOf(attributes: Attributes): URLSearchParams {
  const src = attributes("src") ?? "";
  const at = src.indexOf("#");
  return new URLSearchParams(at < 0 ? "" : src.slice(at + 1));
}

/// Reads which session is meant. Throws an Error that says what is wrong with `src`. `base`: the page's own address.
export function sessionSource(attributes: Attributes, base: string): SessionSource {
  const src = attributes("src") ?? "";
  const address = src.split("#", 1)[0] ?? "";
  let url: URL;
  try {
    url = new URL(address, base);
  } catch {
    throw new Error(`src is no address: ${src}`);
  }
  if (!["http:", "https:", "ws:", "wss:"].includes(url.protocol)) throw new Error(`src is no address of a server: ${src}`);
  const given = parametersOf(attributes);
  return {
    url: socketUrl(url.href),
    token: attributes("token") ?? given.get("token") ?? undefined,
    sessionId: attributes("session") ?? given.get("session"),
  };
}

/// Reads the camera and the settings. What cannot be understood is as in `defaults`.
export function shownSettings(attributes: Attributes, defaults: Settings): { camera: CameraState | null; settings: Settings } {
  const given = parametersOf(attributes);
  for (const name of settingNames) {
    const text = attributes(name);
    if (text !== null) given.set(name, text);
  }
  if (attributes("points") !== null) given.set("budget", "points"); // not, say, the bytes of the address
  const { camera, settings } = readState(given.toString(), defaults);
  return { camera, settings: { ...defaults, dabs: [], marks: [], ...settings, ...withoutTools } };
}
