// SPDX-License-Identifier: Apache-2.0
// The page's handle for scripts and tests.

import type { LiveViewState, PointStore, Session, StatisticsSummary, SurfaceMesh, TriangleMesh } from "../stream";
import type { Viewport } from "../view";
import type { Application } from "./app";
import type { Settings } from "./settings";

/// `window.curvecast`: the state of the page at the moment. Scripts may change the page only through the viewport's own functions
/// (`view.camera = ...`).
export interface Handle {
  readonly state: LiveViewState | "none"; // none: no session is open
  readonly session: Session | null;
  readonly settings: Readonly<Settings>;
  readonly statistics: StatisticsSummary | null;
  readonly look: number; // number of the newest view, as FrameReport.sequence of its frames
  readonly store: PointStore | null; // the view-dependent points, or those of a file
  readonly uniformStore: PointStore | null; // the uniform points of a split view
  readonly surface: SurfaceMesh | null; // the triangles that show instead of the points
  readonly mesh: TriangleMesh | null; // whose edges are drawn
  readonly isMeshCurrent: boolean; // no newer one is being made
  readonly view: Viewport;
}

declare global {
  interface Window {
    curvecast?: Handle;
  }
}

/// Makes the handle of an application.
export function handleOf(app: Application): Handle {
  return Object.freeze({
    get state() {
      return app.streams?.main.state ?? "none";
    },
    get session() {
      return app.session;
    },
    get settings() {
      return Object.freeze({ ...app.settings });
    },
    get statistics() {
      return app.streams?.main.statistics() ?? null;
    },
    get look() {
      return app.streams?.main.lastLook ?? 0;
    },
    get store() {
      return app.points;
    },
    get uniformStore() {
      return app.streams?.uniform?.store ?? null;
    },
    get surface() {
      return app.surface.shown;
    },
    get mesh() {
      return app.mesh?.mesh ?? null;
    },
    get isMeshCurrent() {
      return app.mesh?.isCurrent ?? true;
    },
    view: app.viewport,
  });
}
