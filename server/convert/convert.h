// Converts requests, sessions and reports between core and proto. With its neighbours in this folder it is the only code that
// fills proto messages from core, and the only one that reads requests: every field that a client sent is validated here.
#pragma once

#include <absl/status/statusor.h>

#include "core/pipeline/pipeline.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/convert/field_validator.h"
#include "server/convert/point_set_request.h"
#include "server/session/session.h"

namespace curvecast::server {

// These fill in defaults. InvalidArgument names the field at fault and its value.
absl::StatusOr<PointSetRequest> to_point_set_request(const v1::SampleRequest& request);
/// As to_point_set_request(), for a stream: InvalidArgument where points would jump from view to view.
absl::StatusOr<PointSetRequest> to_streamed_request(const v1::SampleRequest& request);
absl::StatusOr<PreprocessOptions> to_preprocess_options(const v1::SessionOptions& options);
absl::StatusOr<Parameteriser> to_parameteriser(const std::string& field, v1::Parameteriser parameteriser);
/// Errors go to `check`.
std::uint64_t to_chart_faces(FieldValidator& check, const std::string& field, std::uint64_t faces);

v1::Vec3 to_proto(const Vec3d& v);
v1::MeshInfo to_proto(const MeshInfo& info, const std::string& name);
v1::Distortion to_proto(const Distortion& distortion);
v1::Session to_proto(const SessionInfo& info);
v1::Session to_proto(const Session& session);

/// Converts the error of one view; ResourceExhausted says after which time to try again.
v1::FrameError to_proto(const absl::Status& status);

}  // namespace curvecast::server
