// SPDX-License-Identifier: Apache-2.0
// Names of which one is meant.
#pragma once

#include <absl/status/status.h>

#include <span>
#include <string_view>

namespace curvecast::terms {

/// OK when `value` is in `available`; else InvalidArgument: `what` 'value' is not known, with the list of what is.
absl::Status check_choice(std::string_view what, std::string_view value, std::span<const std::string_view> available);

}  // namespace curvecast::terms
