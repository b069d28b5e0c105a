// Densities between core and proto.
#pragma once

#include <string>
#include <vector>

#include "core/density/density.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/convert/checker.h"

namespace curvecast::server {

using DensityTerms = google::protobuf::RepeatedPtrField<v1::DensityTerm>;
using Cameras = google::protobuf::RepeatedPtrField<v1::Camera>;

/// The cameras of `field`, with pictures of the viewport's size. What is wrong goes to `check`.
std::vector<Camera> to_cameras(Checker& check, const std::string& field, const Cameras& cameras,
                               const v1::Viewport& viewport = {});

/// The terms of `field`, with the defaults filled in. Where there are no cameras, those that look from one are an error that says
/// `why`. What is wrong goes to `check`.
Density to_density(Checker& check, const std::string& field, const DensityTerms& terms, std::vector<Camera> cameras,
                   const std::string& why);

v1::DensityTerm to_proto(const DensityTerm& term);

}  // namespace curvecast::server
