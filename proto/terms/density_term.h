// SPDX-License-Identifier: Apache-2.0
// Density terms as people write them.
#pragma once

#include <absl/status/statusor.h>

#include <functional>
#include <string>
#include <string_view>

#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::terms {

/// Returns a file's text. InvalidArgument: it cannot be read.
using FileReader = std::function<absl::StatusOr<std::string>(const std::string& path)>;

/// Parses a factor of a density, which is one of
///   uniform, screen, frustum, picture
///   curvature[:kind=gauss|mean|max,exponent=1,floor=0.05]
///   view[:s0=0.1]
///   distance[:near,far] or distance[:near=..,far=..,global[=inverse-square|inverse|linear]]
///   attribute:NAME, expression:FORMULA
///   brush:x,y,z,radius,factor[,falloff=0.5], more dabs after a semicolon; or brush:@FILE with one in each line
/// Values are checked against the ranges of the API. InvalidArgument names the term, the key and what is allowed. `read` reads a
/// brush's file; without it there are none, as where the text is a stranger's.
absl::StatusOr<v1::DensityTerm> parse_density_term(std::string_view text, const FileReader& read = nullptr);

/// Whether a term looks from a camera.
bool is_camera_term(const v1::DensityTerm& term);

}  // namespace curvecast::terms
