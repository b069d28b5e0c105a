#include "server/store/store.h"

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "server/store/file_store.h"
#include "server/store/s3_store.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kMaxName = 255;  // bytes
constexpr std::string_view kFile = "file://";
constexpr std::string_view kS3 = "s3://";

bool is_part(const std::string& part) {
  return !part.empty() && part.front() != '.' &&
         std::ranges::all_of(part, [](unsigned char c) { return absl::ascii_isalnum(c) || c == '.' || c == '-' || c == '_'; });
}

}  // namespace

bool is_store_name(const std::string& name) {
  const std::vector<std::string> parts = absl::StrSplit(name, '/');
  return name.size() <= kMaxName && std::ranges::all_of(parts, is_part);
}

absl::StatusOr<std::unique_ptr<Store>> open_store(const std::string& url) {
  if (url.starts_with(kFile)) return make_file_store(url.substr(kFile.size()));
  if (url.starts_with(kS3)) {
    const std::pair<std::string, std::string> parts = absl::StrSplit(url.substr(kS3.size()), absl::MaxSplits('/', 1));
    return make_s3_store(parts.first, parts.second);
  }
  return absl::InvalidArgumentError(
      absl::StrCat("the store \"", url, "\" is none: it is file:///DIR, a folder that all servers share, or s3://BUCKET/PREFIX"));
}

}  // namespace curvecast::server
