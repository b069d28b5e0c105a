// SPDX-License-Identifier: Apache-2.0
// Names of what chooses points, and of what else is known of them.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <string_view>

#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::terms {

inline constexpr std::array<std::string_view, 2> kSamplers = {"equalised", "progressive"};
// On a line Niederreiter's sequence in base 2 is van der Corput's: two names of one.
inline constexpr std::array<std::string_view, 5> kSequences = {"jittered", "regular", "vandercorput", "golden", "niederreiter"};
inline constexpr std::array<std::string_view, 5> kAttributes = {"curvatures", "rank", "surface", "directions", "scalars"};

/// Each returns what one of the names above means. InvalidArgument: it is none of them; the message lists them.
absl::StatusOr<v1::Sampler> parse_sampler(std::string_view name);
absl::StatusOr<v1::Sequence> parse_sequence(std::string_view name);
absl::StatusOr<v1::PointAttribute> parse_attribute(std::string_view name);

}  // namespace curvecast::terms
