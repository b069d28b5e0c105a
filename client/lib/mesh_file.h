// SPDX-License-Identifier: Apache-2.0
// Mesh files: .ply, .obj, .off, .stl, .glb and .drc, by the ending of the name.
#pragma once

#include <absl/status/status.h>

#include <string>

#include "mesh.h"

namespace curvecast::client {

/// OK for an ending that write_mesh_file() knows.
absl::Status check_mesh_ending(const std::string& path);

/// Replaces the file, all or nothing. Coordinates are absolute (origin + position).
///   .ply  binary little endian: x y z (doubles when the origin is not zero), nx ny nz, red green blue where there are colours,
///   the mesh's
///         named numbers under their own names
///   .obj  text: positions, colours behind them where there are any, normals
///   .off  text: positions and triangles alone
///   .stl  binary: triangles with their own normals, as floats: coarser than the vertices far from the origin
///   .glb  glTF 2.0: positions relative to a node at the origin, normals, COLOR_0 (linear) where there are colours
///   .drc  Draco: positions as floats, rounded to 2^-16 of the largest side, normals, colours; in an order of Draco's own
/// InvalidArgument: another ending; no triangles for .drc. FailedPrecondition: cannot be written. Messages start with the
/// path.
absl::Status write_mesh_file(const std::string& path, const Mesh& mesh);

}  // namespace curvecast::client
