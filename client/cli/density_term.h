// Density terms as written on the command line.
#pragma once

#include <absl/status/statusor.h>

#include <string>
#include <string_view>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::cli {

inline constexpr char kDensityHelp[] =
    "a factor of the density; repeat to multiply: uniform, curvature[:kind=gauss|mean|max,exponent=1,floor=0.05], view[:s0=0.1]";

/// uniform, curvature[:kind=gauss|mean|max,exponent=1,floor=0.05] or view[:s0=0.1]. Values are checked against the ranges of the
/// API. InvalidArgument names the term, the key and what is allowed.
absl::StatusOr<v1::DensityTerm> parse_density_term(std::string_view text);

/// Appends what the texts say to a message's terms.
absl::Status add_density_terms(const std::vector<std::string>& texts, google::protobuf::RepeatedPtrField<v1::DensityTerm>* terms);

}  // namespace curvecast::cli
