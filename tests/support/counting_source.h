// Memory that computations ask for, counted.
#pragma once

#include <absl/status/status.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "core/base/memory_claim.h"

namespace curvecast::testing {

/// Has `most` bytes, and remembers the most that was taken at once. For computations that ask from one thread at a time.
class CountingSource final : public MemorySource {
 public:
  explicit CountingSource(std::uint64_t most = std::uint64_t{1} << 50) : most_(most) {}

  absl::Status take(std::uint64_t bytes, const std::string& what) override {
    if (taken_ + bytes > most_) return absl::ResourceExhaustedError(what);
    taken_ += bytes;
    peak_ = std::max(peak_, taken_);
    return absl::OkStatus();
  }
  void give_back(std::uint64_t bytes) override { taken_ -= bytes; }
  std::uint64_t most() const override { return most_; }

  std::uint64_t taken() const { return taken_; }
  std::uint64_t peak() const { return peak_; }

 private:
  const std::uint64_t most_;
  std::uint64_t taken_ = 0, peak_ = 0;
};

}  // namespace curvecast::testing
