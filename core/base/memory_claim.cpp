#include "core/base/memory_claim.h"

#include <absl/strings/str_format.h>

#include <array>

namespace curvecast {

absl::Status MemoryClaim::set(std::uint64_t bytes, const std::string& what) {
  if (bytes <= bytes_) {
    give_back(bytes_ - bytes);
    return absl::OkStatus();
  }
  if (source_ != nullptr) {
    if (absl::Status status = source_->take(bytes - bytes_, what); !status.ok()) return status;
  }
  bytes_ = bytes;
  return absl::OkStatus();
}

void MemoryClaim::give_back(std::uint64_t bytes) {
  if (source_ != nullptr && bytes > 0) source_->give_back(bytes);
  bytes_ -= bytes;
}

std::string describe_bytes(double bytes) {
  constexpr std::array kUnits = {"bytes", "kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  for (; bytes >= 999.5 && unit + 1 < kUnits.size(); ++unit) bytes /= 1000;
  return absl::StrFormat("%.*f %s", unit > 0 && bytes < 9.95 ? 1 : 0, bytes, kUnits[unit]);
}

}  // namespace curvecast
