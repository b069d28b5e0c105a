// Density terms as written on the command line.
#pragma once

#include <absl/status/statusor.h>

#include <string>
#include <string_view>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"
#include "proto/terms/density_term.h"

namespace curvecast::cli {

inline constexpr char kDensityHelp[] =
    "a factor of the density; repeat to multiply: uniform, curvature[:kind=gauss|mean|max,exponent=1,floor=0.05], attribute:NAME "
    "(a number that the mesh has for each vertex), brush:x,y,z,radius,factor[,falloff=0.5] (paint: more dabs after a semicolon, "
    "each over those before, or @FILE with one in each "
    "line), expression:FORMULA (of x, y, z, nx, "
    "ny, nz, gauss, mean, k1, k2 and attributes, as in 'expression:(z > 0) + 0.1'); and of the cameras: view[:s0=0.1] "
    "(silhouette), screen (even spacing in pixels), frustum (nothing outside the picture), picture (both, and more at outlines, "
    "bends and edges of colour), distance[:near,far] or "
    "distance[:near=..,far=..,global[=inverse-square|inverse|linear]] (level of detail; global: fewer points instead of another "
    "density)";

/// One of kDensityHelp, see terms::parse_density_term(); reads files.
absl::StatusOr<v1::DensityTerm> parse_density_term(std::string_view text);

using terms::is_camera_term;

/// Appends what the texts say to a message's terms.
absl::Status add_density_terms(const std::vector<std::string>& texts, google::protobuf::RepeatedPtrField<v1::DensityTerm>* terms);

}  // namespace curvecast::cli
