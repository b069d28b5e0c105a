// Which other files a mesh file asks for.
#pragma once

#include <absl/status/statusor.h>

#include <string>
#include <vector>

#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast {

inline constexpr std::size_t kMaxCompanions = 256;

/// Lists the files that the mesh refers to and that `file.companion` does not have yet, by the names it will be asked for, each
/// once, in the order of the file: an OBJ's material libraries, and the textures of the libraries that are there; a PLY's
/// textures; a glTF's buffers and base-colour images. Ask again after adding some, until nothing new comes; some may never be
/// found. At most kMaxCompanions names. Every name is safe to join to the mesh's folder (see safe_companion_name); names that
/// cannot be made safe are left out. InvalidArgument when the format is unknown; what else is wrong with the file is for
/// read_mesh to say.
absl::StatusOr<std::vector<std::string>> mesh_companions(const MeshFile& file);

}  // namespace curvecast
