// SPDX-License-Identifier: Apache-2.0
// Decodes a surface's file of Draco. Runs in a worker, and needs nothing of a browser.

import { withNormals } from "./corner_normals";
import type { EncodedSurface, SurfaceMesh } from "./decoded_surface";
import { DracoLibrary } from "./draco/library";
import { badSurface, checkMeshHeader } from "./draco/mesh_header";

/// Decodes a file. Rejects bad data with DATA_LOSS. Takes a decoder of its own by default, whose memory goes with it.
export async function decodeSurface(encoded: EncodedSurface, library = new DracoLibrary()): Promise<SurfaceMesh> {
  const { file, vertices, triangles, origin, creaseDegrees } = encoded;
  checkMeshHeader(file, vertices, triangles);
  const mesh = await library.readMesh(file, vertices, triangles);
  if (!mesh.positions.every(Number.isFinite)) throw badSurface("a position that is not finite");
  if (!mesh.triangles.every((vertex) => vertex < vertices)) throw badSurface(`a triangle that is not between ${vertices} vertices`);
  const { sources, ...shaded } = withNormals(mesh.positions, mesh.triangles, creaseDegrees);
  return { ...shaded, colours: mesh.colours && coloursOf(mesh.colours, sources), origin, bytes: file.length };
}

function coloursOf(colours: Uint8Array, sources: Uint32Array): Uint8Array<ArrayBuffer> {
  const out = new Uint8Array(3 * sources.length);
  for (let vertex = 0; vertex < sources.length; ++vertex) {
    for (let k = 0; k < 3; ++k) out[3 * vertex + k] = colours[3 * sources[vertex]! + k]!;
  }
  return out;
}
