// What follows the "?" of an address.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace curvecast::server {

/// Returns the text with each %XX as its byte and, in a query, each + as a blank. InvalidArgument: a % without two hexadecimal
/// digits, or what is no UTF-8 then.
absl::StatusOr<std::string> percent_decoded(std::string_view text, bool is_query);

/// The parts NAME=VALUE of a query, decoded, in their order. InvalidArgument as of percent_decoded(); more than 256 parts.
absl::StatusOr<std::vector<std::pair<std::string, std::string>>> parse_query(std::string_view query);

/// The page of a list that is asked for.
struct PageTerms {
  std::uint32_t size = 0;  // 0: as the list has it
  std::string token;       // empty: the first
};
/// InvalidArgument: a part that is neither page_size=COUNT nor page_token.
absl::StatusOr<PageTerms> read_page_terms(const std::vector<std::pair<std::string, std::string>>& query);

/// The error of a part of a query: "query: 'NAME=VALUE': WANT".
absl::Status bad_query_part(const std::pair<std::string, std::string>& part, std::string_view want);

/// Returns a name that may stand in a header: letters, digits, dots, underlines and hyphens of ASCII stay, "_" stands for all
/// else; 64 bytes at most, and "points" instead of none.
std::string header_name_of(std::string_view name);

}  // namespace curvecast::server
