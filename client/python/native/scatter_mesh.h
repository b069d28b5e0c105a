// Points straight on a mesh, for one set of them, where a LocalSurface would be cut and flattened first. Knows nothing of Python.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/execution_context.h"
#include "core/mesh/polygon_soup.h"
#include "core/sample/point_set.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/convert/point_set_request.h"

namespace curvecast::python {

struct ScatteredPoints {
  PointSet points;                               // of whose places the faces are polygons of the soup
  std::optional<std::vector<float>> curvatures;  // 2 N, 1/unit; directions: 3 N; both where they were asked for
  std::optional<std::vector<float>> directions;
  std::vector<std::pair<std::string, std::vector<float>>> scalars;  // N each, under their names
};

/// Repairs the mesh and scatters points on it as `request` says: see scatter(). `name`: of messages. InvalidArgument: of the mesh
/// (repair()), another budget than a number of points, a sampler or a sequence that there is none of, crease_degrees that are not
/// 0 .. 180; errors of scatter(); Cancelled.
absl::StatusOr<ScatteredPoints> scatter_mesh(PolygonSoup soup, const std::string& name, const v1::SampleRequest& request,
                                             std::optional<double> crease_degrees, const ExecutionContext& context);

}  // namespace curvecast::python
