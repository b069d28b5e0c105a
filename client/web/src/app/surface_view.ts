// SPDX-License-Identifier: Apache-2.0
// Shows the surface's own triangles where the user wants them, or where they are fewer bytes than points.

import type { Client, Session, SurfaceMesh } from "../stream";
import type { Mode, Viewport } from "../view";
import { bytes, count } from "./format";
import { isDrawnSoon, isMeshSmaller, suitsMesh } from "./mesh_choice";
import type { Settings } from "./settings";
import { SurfaceFollower } from "./surface_follower";

const noGraphics = "this browser's graphics cannot draw it";

/// What it calls. `changed`: there is another answer to follow.
export interface SurfaceViewEvents {
  changed(): void;
  notice(text: string): void;
}

/// Decides for one session at a time whether its triangles are asked for, and whether they show.
export class SurfaceView {
  private follower: SurfaceFollower | null = null;
  private faces = 0; // of the session's mesh; 0: not known
  private isTold = false; // why there are no triangles
  private isWantedByUser = false;
  private isShown = false;
  private isWorthWaiting = false; // points until then would be more bytes

  constructor(
    private readonly client: Client,
    private readonly viewport: Viewport,
    private readonly defaults: Settings,
    private readonly events: SurfaceViewEvents,
  ) {}

  /// Is about no session from now on.
  close(): void {
    this.follower?.close();
    this.follower = null;
    this.viewport.setSurface(null);
    this.isShown = this.isTold = false;
  }

  /// Is about another session from now on.
  open(session: Session): void {
    this.close();
    this.faces = Number(session.report?.mesh?.faces ?? 0n);
    const follower = new SurfaceFollower(
      (options) => this.client.surface(session.sessionId, options),
      () => {
        if (this.follower !== follower) return;
        this.viewport.setSurface(follower.mesh);
        this.events.changed();
      },
    );
    this.follower = follower;
  }

  /// Follows the settings. `pointBytes`: that have come for the session. `isReady`: there is more of it than a preview. Returns whether
  /// something else shows than before.
  follow(settings: Settings, pointBytes: number, isReady: boolean): boolean {
    const { follower, viewport, faces } = this;
    if (follower === null) return false;
    const wasShown = this.isShown;
    this.isWantedByUser = settings.mode === "mesh";
    const isBetter = isDrawnSoon(faces, viewport.isSoftware) && isMeshSmaller(faces, pointBytes, this.defaults.points);
    const isWanted = isReady && (this.isWantedByUser || (isBetter && suitsMesh(settings, this.defaults)));
    follower.follow(isWanted && viewport.drawsSurfaces);
    this.isShown = isWanted && follower.mesh !== null;
    this.isWorthWaiting = isMeshSmaller(faces, 0, this.defaults.points);
    const why = viewport.drawsSurfaces ? follower.refusal?.message : noGraphics;
    if (this.isWantedByUser && why !== undefined && !this.isTold) {
      this.isTold = true;
      this.events.notice(`The surface is drawn by discs, as its mesh cannot be shown: ${why}`);
    }
    return this.isShown !== wasShown;
  }

  /// The triangles that show instead of the points; null: the points show.
  get shown(): SurfaceMesh | null {
    return this.isShown ? (this.follower?.mesh ?? null) : null;
  }

  /// Whether the points are needed: they show, or will until the triangles are there.
  get needsPoints(): boolean {
    return !this.isShown && !(this.follower?.isAsked === true && this.isWorthWaiting);
  }

  /// What the viewport is to draw.
  modeOf(settings: Settings): Mode {
    return this.isShown ? "mesh" : settings.mode;
  }

  /// What the figures say; null: nothing.
  get text(): string | null {
    const mesh = this.shown;
    if (mesh === null) return this.follower?.isAsked === true ? "mesh …" : null;
    const figures = `mesh: ${count(mesh.triangles.length / 3)} triangles, ${bytes(mesh.bytes)}`;
    return this.isWantedByUser ? figures : `${figures}, fewer bytes than points`;
  }
}
