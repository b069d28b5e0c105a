// SPDX-License-Identifier: Apache-2.0
// The files that a mesh refers to, in its own folder: nothing else may be read on the word of a mesh or a server.
#pragma once

#include <absl/status/statusor.h>

#include <string>
#include <string_view>

#include "client/lib/file_bytes.h"

namespace curvecast::client {

/// Whether a mesh file of this name can refer to others: .obj, .gltf, .glb and .ply can.
bool may_have_companions(std::string_view path);

/// Opens the file `name` that the mesh at `mesh_path` refers to: a regular, non-empty file in the mesh's folder or below, with
/// the ending of a material library, buffer or picture. Symbolic links are followed as long as they stay there. InvalidArgument:
/// a name that is absolute, goes up, has a hidden part or another ending, or leads out of the folder. NotFound: no such file. The
/// folder must not change meanwhile.
absl::StatusOr<InputFile> open_companion(const std::string& mesh_path, std::string_view name);

}  // namespace curvecast::client
