// Cameras that see a whole mesh.
#pragma once

#include <absl/status/statusor.h>

#include "curvecast/v1/curvecast.pb.h"
#include "proto/terms/camera_term.h"

namespace curvecast::server {

/// A three-quarter view of all of a mesh. `aspect`: of the picture, width / height. `margin`: share of it that stays free on
/// every side.
v1::Camera whole_view(const v1::MeshInfo& mesh, double aspect, double fov_degrees, double margin);
/// The camera of a term, for a mesh: as on the command line. InvalidArgument as of terms::complete_camera().
absl::StatusOr<v1::Camera> complete_camera(const terms::CameraTerm& term, const v1::MeshInfo& mesh, double aspect);

}  // namespace curvecast::server
