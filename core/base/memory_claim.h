// Memory is asked for before it is taken: who computes says how much, who runs the computations says whether there is so much.
#pragma once

#include <absl/status/status.h>

#include <cstdint>
#include <string>

#include "core/base/execution_context.h"

namespace curvecast {

/// Where computations ask for memory. Thread-safe.
class MemorySource {
 public:
  MemorySource() = default;
  virtual ~MemorySource() = default;
  MemorySource(const MemorySource&) = delete;
  MemorySource& operator=(const MemorySource&) = delete;

  /// The caller takes so many bytes more. May wait until others have given some back. ResourceExhausted where there are not so
  /// many: `what` says what they are for ("17000000 triangles take 2.1 GB").
  virtual absl::Status take(std::uint64_t bytes, const std::string& what) = 0;
  /// The caller has so many bytes less.
  virtual void give_back(std::uint64_t bytes) = 0;
  /// The most that there may be for one computation.
  virtual std::uint64_t most() const = 0;
};

/// What a part of a computation takes; none where the context has no source. Not thread-safe.
class MemoryClaim {
 public:
  explicit MemoryClaim(const ExecutionContext& context) : source_(context.memory) {}
  ~MemoryClaim() { give_back(bytes_); }
  MemoryClaim(const MemoryClaim&) = delete;
  MemoryClaim& operator=(const MemoryClaim&) = delete;

  /// From now on, the part takes so many bytes at most. Errors as of MemorySource::take(): it takes what it took before.
  absl::Status set(std::uint64_t bytes, const std::string& what);
  std::uint64_t bytes() const { return bytes_; }

 private:
  void give_back(std::uint64_t bytes);

  MemorySource* const source_;  // may be null
  std::uint64_t bytes_ = 0;
};

/// "2.1 GB", "640 MB", "12 kB".
std::string describe_bytes(double bytes);

}  // namespace curvecast
