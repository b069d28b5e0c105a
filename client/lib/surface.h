// The surface of a session itself, as the server sends it: a file of Draco.
#pragma once

#include <absl/status/statusor.h>

#include <span>
#include <string>

#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::client {

struct Surface {
  v1::SurfaceInfo info;
  std::string drc;  // a mesh, as Draco's own draco_decoder opens it; positions are relative to the info's origin
};

/// Joins the chunks. DataLoss unless there are as many bytes as announced, of a mesh in Draco's form. What the bytes say is not
/// looked at.
absl::StatusOr<Surface> join_surface(std::span<const v1::GetSurfaceResponse> responses);

}  // namespace curvecast::client
