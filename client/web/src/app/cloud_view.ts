// SPDX-License-Identifier: Apache-2.0
// The points of a user's own file, which show instead of a session. No server knows of them.

import { CloudStore, type Cloud } from "../cloud";
import type { Viewport } from "../view";
import type { Messages } from "./messages";
import type { Settings } from "./settings";

const here = "shown from its file: nothing was sent, and the link does not hold it";

/// Shows one cloud at a time, or none.
export class CloudView {
  private shown: { name: string; store: CloudStore } | null = null;

  constructor(
    private readonly viewport: Viewport,
    private readonly messages: Messages,
  ) {}

  get store(): CloudStore | null {
    return this.shown?.store ?? null;
  }

  /// The name of its file.
  get name(): string | null {
    return this.shown?.name ?? null;
  }

  /// Shows the points of a file, the whole of them.
  open(name: string, cloud: Cloud): void {
    const store = new CloudStore(cloud);
    this.shown = { name, store };
    this.viewport.setBounds(cloud.min, cloud.max);
    this.viewport.setStores(store);
    this.viewport.frame();
    this.messages.notice(`${name} is ${here}`);
    for (const notice of cloud.notices) this.messages.notice(notice);
  }

  /// Is about no cloud from now on. The viewport draws its points until it gets others.
  close(): void {
    this.shown = null;
  }
}

/// Sets what a cloud begins with: its own colours, and Z up where files of its kind always have it so.
export function beginCloud(settings: Settings, name: string, { colours }: Cloud): void {
  settleForCloud(settings);
  if (colours !== null) settings.colouring = "colour";
  if (/\.(las|pts)$/i.test(name)) settings.up = "z";
}

/// Takes back what only sessions have: a cloud has all of its points, wherever the camera is.
export function settleForCloud(settings: Settings): void {
  settings.frozen = settings.split = settings.brush = settings.wireframe = false;
  if (settings.mode === "mesh") settings.mode = "splats";
  // What only points of a session have is not to be seen on others.
  if (settings.colouring === "curvature" || settings.colouring === "rank") settings.colouring = "colour";
}
