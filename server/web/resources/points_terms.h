// What queries for files of points say.
#pragma once

#include <absl/status/statusor.h>

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"
#include "proto/terms/camera_term.h"
#include "server/web/resources/point_file.h"
#include "server/web/resources/resource.h"

namespace curvecast::server {

/// What the query of a point set says, all but what takes the mesh to know.
struct PointsTerms {
  v1::SampleRequest sample;                // without cameras and, where no budget was given, without that
  std::vector<terms::CameraTerm> cameras;  // none: one of which nothing is said, where the density wants one
  PointFileTerms file;
};

/// The same of points that are scattered on a mesh.
struct ScatterTerms {
  PointsTerms points;                             // with a budget
  std::map<std::string, std::string> companions;  // from names to ids
  std::optional<double> crease_degrees;
};

/// Reads a part of a query that matters to all files of points. Null: it is none of them. InvalidArgument names it.
std::optional<absl::Status> read_sample_part(const std::pair<std::string, std::string>& part, PointsTerms& terms);

/// InvalidArgument names the part at fault.
absl::StatusOr<PointsTerms> read_points_query(const WebResource::Query& query, const PointFileKind& kind);
absl::StatusOr<ScatterTerms> read_scatter_query(const WebResource::Query& query, const PointFileKind& kind);

/// Whether cameras have to be completed for the mesh's box.
bool has_cameras(const PointsTerms& terms);
/// Adds the cameras, which the query left to the mesh, to the request for points.
absl::Status complete_sample(const v1::MeshInfo& mesh, PointsTerms& terms);

}  // namespace curvecast::server
