// Converts measures of point sets between core and proto.
#pragma once

#include <absl/status/statusor.h>

#include <vector>

#include "core/measure/hausdorff.h"
#include "core/measure/measure_points.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/session/mesh_store.h"

namespace curvecast::server {

/// Converts all but mesh and points, and fills in defaults. InvalidArgument names the field at fault and its value.
absl::StatusOr<MeasureOptions> to_measure_options(const v1::MeasureRequest& request);

/// Converts what it says of the other mesh. InvalidArgument names the field at fault and its value.
absl::StatusOr<HausdorffOptions> to_hausdorff_options(const v1::MeasureRequest& request);

/// Reads the points of all sets in absolute coordinates; files[s], which is open, holds those of set s. InvalidArgument and
/// OutOfRange name the set at fault.
absl::StatusOr<std::vector<std::vector<Vec3d>>> to_point_sets(const v1::MeasureRequest& request,
                                                              const std::vector<std::shared_ptr<const Mesh>>& files);

/// Converts a report; distances become percentages of `diagonal`, that of the mesh's box.
v1::Measures to_proto(const MeasureReport& report, double diagonal);
v1::MeshDistance to_proto(const HausdorffDistance& distance, double diagonal);

}  // namespace curvecast::server
