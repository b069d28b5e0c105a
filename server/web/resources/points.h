// Point sets of a session as files.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"
#include "proto/terms/camera_term.h"
#include "server/web/resources/point_file.h"
#include "server/web/resources/resource.h"

namespace curvecast::server {

/// What the query of a point set says, all but what takes the session to know.
struct PointsTerms {
  v1::SampleRequest sample;                // without cameras and, where no budget was given, without that
  std::vector<terms::CameraTerm> cameras;  // none: one of which nothing is said, where the density wants one
  PointFileTerms file;
};

/// Reads a part of a query that matters to all files of points. Null: it is none of them. InvalidArgument names it.
std::optional<absl::Status> read_sample_part(const std::pair<std::string, std::string>& part, PointsTerms& terms);

/// InvalidArgument names the part at fault.
absl::StatusOr<PointsTerms> read_points_query(const WebResource::Query& query, const PointFileKind& kind);

/// Fills in what the query left to the session: cameras for the mesh's box, and the budget.
absl::Status complete_sample(const std::vector<terms::CameraTerm>& cameras, const v1::Session& session,
                             v1::SampleRequest& sample);

/// GET: the points as a file of this kind, by Resample.
void get_points(const std::shared_ptr<WebResource>& resource, const std::string& session_id, const PointFileKind& kind);

}  // namespace curvecast::server
