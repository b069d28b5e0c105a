#include "core/base/text_scanner.h"

#include <absl/strings/escaping.h>
#include <absl/strings/match.h>
#include <absl/strings/str_format.h>

#include <algorithm>

namespace curvecast {

absl::Status TextScanner::error(std::string_view message) const {
  return absl::InvalidArgumentError(absl::StrFormat("line %d: %s", line_, message));
}

absl::Status TextScanner::expected(std::string_view what) const {
  if (at_end()) return error(absl::StrFormat("expected %s, but the file ends here", what));
  if (at_line_end()) return error(absl::StrFormat("expected %s, but the line ends here", what));
  return error(absl::StrFormat("expected %s, found '%s'", what, printable(peek_word())));
}

std::string printable(std::string_view word) {
  constexpr std::size_t kLongest = 32;
  const std::string escaped = absl::CHexEscape({word.data(), std::min(word.size(), kLongest)});
  return word.size() > kLongest ? escaped + "..." : escaped;
}

bool equals_ignoring_case(std::string_view a, std::string_view b) {
  return absl::EqualsIgnoreCase({a.data(), a.size()}, {b.data(), b.size()});
}

}  // namespace curvecast
