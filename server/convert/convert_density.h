// Converts densities and cameras between core and proto.
#pragma once

#include <string>
#include <vector>

#include "core/density/density.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/convert/field_validator.h"

namespace curvecast::server {

using DensityTerms = google::protobuf::RepeatedPtrField<v1::DensityTerm>;
using Cameras = google::protobuf::RepeatedPtrField<v1::Camera>;

/// Converts the cameras of `field`; their pictures have the viewport's size, or are square without one. Errors go to `check`.
std::vector<Camera> to_cameras(FieldValidator& check, const std::string& field, const Cameras& cameras,
                               const v1::Viewport& viewport = {});

/// Checks a request's viewport, where it has one. Errors go to `check`.
void check_viewport(FieldValidator& check, const std::string& field, const v1::Viewport* viewport);

/// Converts the terms of `field` and fills in defaults. Where `cameras` is empty, a term that needs a camera is an error that
/// says `why`. Errors go to `check`.
Density to_density(FieldValidator& check, const std::string& field, const DensityTerms& terms, std::vector<Camera> cameras,
                   const std::string& why);

/// Converts a term; all its fields are set.
v1::DensityTerm to_proto(const DensityTerm& term);

}  // namespace curvecast::server
