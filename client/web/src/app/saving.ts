// What the page shows, as files for the user.

import { asCurvecastError, type Session } from "../stream";
import type { DrawOver, Viewport } from "../view";
import { meshPlyOf, plyOf } from "./export_ply";
import type { MeshFollower } from "./mesh_follower";
import type { Messages } from "./messages";
import { nameOf } from "./session_list";
import type { Streams } from "./streams";

/// What there is to be saved.
export interface Shown {
  readonly session: Session | null;
  readonly streams: Streams | null;
  readonly mesh: MeshFollower | null;
  readonly viewport: Viewport;
  readonly messages: Messages;
  /// Draws over the picture.
  readonly annotations: { readonly draw: DrawOver };
}

/// Returns the name of a session's mesh without its extension.
function stemOf(session: Session): string {
  return nameOf(session).replace(/\.[a-z]+$/i, "");
}

/// Saves the picture as PNG, with `scale` times as many pixels in each direction as on the page.
export async function savePicture({ session, viewport, messages, annotations }: Shown, scale: number): Promise<void> {
  if (session === null) return;
  try {
    download(await viewport.screenshot(scale, annotations.draw), `${stemOf(session)}.png`);
  } catch (thrown) {
    messages.failure("The picture cannot be saved", asCurvecastError(thrown));
  }
}

/// Saves a film that is to be made.
export async function saveFilm({ session }: Shown, film: Promise<Blob | null>): Promise<void> {
  const blob = await film;
  if (session !== null && blob !== null) download(blob, `${stemOf(session)}.webm`);
}

/// Saves the points as PLY.
export function savePoints({ session, streams, messages }: Shown): void {
  if (session === null || streams === null) return;
  const { store } = streams.main;
  if (store.count === 0) return messages.notice("There are no points yet: discs (1) and dots (2) ask for some");
  download(plyOf(store), `${stemOf(session)}-${store.count}.ply`);
}

/// Saves the mesh whose edges are drawn as PLY.
export function saveMesh({ session, mesh: follower }: Shown): void {
  const mesh = follower?.mesh;
  if (session === null || mesh == null) return;
  download(meshPlyOf(mesh), `${stemOf(session)}-mesh-${mesh.vertices.count}.ply`);
}

/// Offers a file to the user as a download.
function download(blob: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
