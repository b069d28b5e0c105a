// What a client wants of points that are scattered on a mesh, checked.
#pragma once

#include <absl/status/statusor.h>

#include <optional>

#include "core/pipeline/scatter_mesh.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/convert/point_set_request.h"

namespace curvecast::server {

struct ScatterRequest {
  MeshScatter scatter;
  PointSetRequest point_set;  // how the points are sent
};

/// As to_point_set_request(). InvalidArgument, too: another budget than a number of points, another sampler or a sequence; an
/// angle out of range.
absl::StatusOr<ScatterRequest> to_scatter_request(const v1::SampleRequest& sample, std::optional<double> crease_degrees);

}  // namespace curvecast::server
