// SPDX-License-Identifier: Apache-2.0
// What the page shows, as files for the user.

import { asCurvecastError } from "../stream";
import type { DrawOver, Viewport } from "../view";
import { meshPlyOf, plyOf, type ListedPoints } from "./export_ply";
import type { MeshFollower } from "./mesh_follower";
import type { Messages } from "./messages";

/// What there is to be saved.
export interface Shown {
  /// The name of the file that it is from; null: nothing is shown.
  readonly name: string | null;
  readonly points: ListedPoints | null;
  readonly mesh: MeshFollower | null;
  readonly viewport: Viewport;
  readonly messages: Messages;
  /// Draws over the picture.
  readonly annotations: { readonly draw: DrawOver };
}

/// Returns a file's name without its extension.
const stemOf = (name: string): string => name.replace(/\.[a-z]+$/i, "").replace(/^.*\//, "");

/// Saves the picture as PNG, with `scale` times as many pixels in each direction as on the page.
export async function savePicture({ name, viewport, messages, annotations }: Shown, scale: number): Promise<void> {
  if (name === null) return;
  try {
    download(await viewport.screenshot(scale, annotations.draw), `${stemOf(name)}.png`);
  } catch (thrown) {
    messages.failure("The picture cannot be saved", asCurvecastError(thrown));
  }
}

/// Saves a film that is to be made.
export async function saveFilm({ name }: Shown, film: Promise<Blob | null>): Promise<void> {
  const blob = await film;
  if (name !== null && blob !== null) download(blob, `${stemOf(name)}.webm`);
}

/// Saves the points as PLY.
export function savePoints({ name, points, messages }: Shown): void {
  if (name === null || points === null) return;
  if (points.count === 0) return messages.notice("There are no points yet: discs (1) and dots (2) ask for some");
  download(plyOf(points), `${stemOf(name)}-${points.count}.ply`);
}

/// Saves the mesh whose edges are drawn as PLY.
export function saveMesh({ name, mesh: follower }: Shown): void {
  const mesh = follower?.mesh;
  if (name === null || mesh == null) return;
  download(meshPlyOf(mesh), `${stemOf(name)}-mesh-${mesh.vertices.count}.ply`);
}

/// Offers a file to the user as a download.
function download(blob: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
