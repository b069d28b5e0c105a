#include "server/store/store.h"

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <absl/strings/strip.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "server/store/file_store.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kMaxName = 255;  // bytes

bool is_part(std::string_view part) {
  return !part.empty() && part.front() != '.' && std::ranges::all_of(part, [](unsigned char c) {
    return absl::ascii_isalnum(c) || c == '.' || c == '-' || c == '_';
  });
}

}  // namespace

bool is_store_name(const std::string& name) {
  const std::vector<std::string_view> parts = absl::StrSplit(name, '/');
  return name.size() <= kMaxName && std::ranges::all_of(parts, is_part);
}

absl::StatusOr<std::unique_ptr<Store>> open_store(const std::string& url) {
  std::string_view rest = url;
  if (absl::ConsumePrefix(&rest, "file://")) return make_file_store(std::string(rest));
  if (absl::StartsWith(url, "s3://")) return absl::InvalidArgumentError(absl::StrCat(url, ": this build has no S3"));
  return absl::InvalidArgumentError(
      absl::StrCat("the store \"", url, "\" is none: it is file:///DIR, a folder that all servers share, or s3://BUCKET/PREFIX"));
}

}  // namespace curvecast::server
