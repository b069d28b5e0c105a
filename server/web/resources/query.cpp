#include "server/web/resources/query.h"

#include <absl/strings/ascii.h>
#include <absl/strings/escaping.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <google/protobuf/stubs/common.h>

#include "server/base/log.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kMostParts = 256;
constexpr std::size_t kMostOfName = 64;  // bytes

}  // namespace

absl::StatusOr<std::string> percent_decoded(std::string_view text, bool is_query) {
  std::string decoded;
  decoded.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded += is_query && text[i] == '+' ? ' ' : text[i];
      continue;
    }
    const std::string_view digits = text.substr(i + 1, 2);
    if (digits.size() != 2 || !absl::ascii_isxdigit(digits[0]) || !absl::ascii_isxdigit(digits[1])) {
      return absl::InvalidArgumentError(absl::StrCat("the address has a % without two hexadecimal digits: ", printable(text)));
    }
    decoded += absl::HexStringToBytes(absl::string_view(digits.data(), 2));
    i += 2;
  }
  if (!google::protobuf::internal::IsStructurallyValidUTF8(decoded.data(), static_cast<int>(decoded.size())))
    return absl::InvalidArgumentError(absl::StrCat("the address is not UTF-8: ", printable(text)));
  return decoded;
}

absl::StatusOr<std::vector<std::pair<std::string, std::string>>> parse_query(std::string_view query) {
  std::vector<std::pair<std::string, std::string>> parts;
  for (const absl::string_view part : absl::StrSplit(absl::string_view(query.data(), query.size()), '&', absl::SkipEmpty())) {
    if (parts.size() == kMostParts) {
      return absl::InvalidArgumentError(absl::StrCat("the query has more than ", kMostParts, " parts"));
    }
    const std::pair<absl::string_view, absl::string_view> named = absl::StrSplit(part, absl::MaxSplits('=', 1));
    absl::StatusOr<std::string> name = percent_decoded({named.first.data(), named.first.size()}, true);
    if (!name.ok()) return name.status();
    absl::StatusOr<std::string> value = percent_decoded({named.second.data(), named.second.size()}, true);
    if (!value.ok()) return value.status();
    parts.emplace_back(*std::move(name), *std::move(value));
  }
  return parts;
}

absl::StatusOr<PageTerms> read_page_terms(const std::vector<std::pair<std::string, std::string>>& query) {
  PageTerms terms;
  for (const auto& [key, value] : query) {
    if (key == "page_size" && absl::SimpleAtoi(value, &terms.size)) continue;
    if (key != "page_token") {
      return absl::InvalidArgumentError(absl::StrCat("query: '", printable(key + "=" + value),
                                                     "' is nothing that a list has; there are: page_size=COUNT, page_token"));
    }
    terms.token = value;
  }
  return terms;
}

absl::Status bad_query_part(const std::pair<std::string, std::string>& part, std::string_view want) {
  return absl::InvalidArgumentError(
      absl::StrCat("query: '", printable(part.first + "=" + part.second), "': ", std::string(want)));
}

std::string header_name_of(std::string_view name) {
  std::string out;
  for (const char c : name.substr(0, kMostOfName)) {
    const bool stays = absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '_' || c == '-';
    out += stays ? c : '_';
  }
  return out.empty() ? "points" : out;
}

}  // namespace curvecast::server
