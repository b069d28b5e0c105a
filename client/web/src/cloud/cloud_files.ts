// SPDX-License-Identifier: Apache-2.0
// Which files are point clouds, and which have a surface.

import type { NamedFile } from "../stream/mesh_upload";
import { bytesAt } from "./file_bytes";
import { hasFaces, headerBytes, parsePlyHeader } from "./ply_header";

const mesh = /\.(ply|obj|off|stl|gltf|glb|3mf)$/i; // PLY files may be either
const cloud = /\.(xyz|txt|asc|pts|csv|las|laz)$/i;

/// Finds the point cloud among several files: a PLY file without faces, or one whose name says so, unless a mesh is among them. A PLY file
/// whose header cannot be read is none: the server says what is wrong with it. Returns null where there is none.
export async function cloudAmong(files: readonly NamedFile[]): Promise<NamedFile | null> {
  const model = files.find(({ name }) => mesh.test(name));
  if (model === undefined) return files.find(({ name }) => cloud.test(name)) ?? null;
  return /\.ply$/i.test(model.name) && (await isPlyCloud(model.data)) ? model : null;
}

/// Whether a PLY file has a header, and no faces.
async function isPlyCloud(file: Blob): Promise<boolean> {
  try {
    return !hasFaces(parsePlyHeader(await bytesAt(file, 0, headerBytes)));
  } catch {
    return false;
  }
}
