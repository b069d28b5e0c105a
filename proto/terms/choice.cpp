// SPDX-License-Identifier: Apache-2.0
#include "proto/terms/choice.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>

#include <algorithm>
#include <string>

namespace curvecast::terms {

absl::Status check_choice(std::string_view what, std::string_view value, std::span<const std::string_view> available) {
  if (std::find(available.begin(), available.end(), value) != available.end()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("there is no ", std::string(what), " '", std::string(value),
                   "'; there are: ", absl::StrJoin(available, ", ", [](std::string* out, auto name) { out->append(name); })));
}

}  // namespace curvecast::terms
