// Reads meshes in Draco's form, with the positions that are left of them.
#pragma once

#include <absl/status/statusor.h>

#include <string_view>

#include "core/base/vec.h"
#include "core/pipeline/pipeline.h"

namespace curvecast::cli::bench {

/// Returns the mesh, repaired, with colours where its vertices have any. `origin` is added to its positions. DataLoss with
/// Draco's message. Precondition: the bytes can be trusted, as Draco trusts them.
absl::StatusOr<LoadedMesh> decode_drc_mesh(std::string_view bytes, const Vec3d& origin);

}  // namespace curvecast::cli::bench
