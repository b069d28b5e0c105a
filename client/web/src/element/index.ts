// SPDX-License-Identifier: Apache-2.0
// Defines <curvecast-view>, three.js and all: a page needs nothing else.

import { CurvecastView } from "./curvecast_view";

if ("customElements" in globalThis && customElements.get("curvecast-view") === undefined) {
  customElements.define("curvecast-view", CurvecastView);
}

declare global {
  interface HTMLElementTagNameMap {
    "curvecast-view": CurvecastView;
  }
}

export { CurvecastView, type CurvecastViewEvents } from "./curvecast_view";
export type { CameraState, Vec } from "../view/types";
export type { CurvecastError, ErrorCode, FrameReport, Session } from "../stream";
