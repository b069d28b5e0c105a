// The only code between core and proto: checks every field that a client sent, and converts both ways.
#pragma once

#include <absl/status/statusor.h>

#include "core/pipeline/pipeline.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/convert/sample.h"
#include "server/session/session.h"

namespace curvecast::server {

// Defaults are filled in. InvalidArgument names the field at fault and its value.
absl::StatusOr<Sample> to_sample(const v1::SampleRequest& request);
absl::StatusOr<PreprocessOptions> to_preprocess_options(const v1::SessionOptions& options);
absl::StatusOr<Parameteriser> to_parameteriser(const std::string& field, v1::Parameteriser parameteriser);

v1::Vec3 to_proto(const Vec3d& v);
v1::MeshInfo to_proto(const MeshInfo& info, const std::string& name);
v1::Distortion to_proto(const Distortion& distortion);
v1::Session to_proto(const SessionInfo& info);
v1::Session to_proto(const Session& session);

v1::FrameError to_proto(const absl::Status& status);

}  // namespace curvecast::server
