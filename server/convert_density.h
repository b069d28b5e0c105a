// Densities between core and proto.
#pragma once

#include <absl/status/statusor.h>

#include <string>
#include <vector>

#include "core/density/density.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/checker.h"

namespace curvecast::server {

using DensityTerms = google::protobuf::RepeatedPtrField<v1::DensityTerm>;

/// The eye of a camera that looks somewhere; what is wrong goes to `check`.
Vec3d check_camera(Checker& check, const std::string& field, const v1::Camera& camera);

/// The terms of `field`, with the defaults filled in. View terms look from `eye`; where there is none, its status says why they
/// are an error. What is wrong goes to `check`.
std::vector<DensityTerm> to_density(Checker& check, const std::string& field, const DensityTerms& terms,
                                    const absl::StatusOr<Vec3d>& eye);

/// The eye of a view term is lost: it is the camera's.
v1::DensityTerm to_proto(const DensityTerm& term);

}  // namespace curvecast::server
