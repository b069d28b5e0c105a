// Bounds the memory of this process: large blocks beyond it lie in a file, from which the system has their pages back whenever
// somebody else wants them.
#pragma once

#include <absl/status/status.h>

#include <cstddef>
#include <cstdint>
#include <new>
#include <string>

namespace curvecast {

/// Why a large block could not be had: its file's disk is full, or there are too many.
class SpillError : public std::bad_alloc {
 public:
  explicit SpillError(const char* what) : what_(what) {}
  const char* what() const noexcept override { return what_; }

 private:
  const char* what_;  // a literal
};

/// Has this process, from now on, take about `bytes` of memory at most: blocks of kLeastSpill and more for which there is no
/// room are mapped from a file without a name in `folder`, and their pages given back when all of the process takes more. Once
/// begun, further calls change the bound alone. It concerns those programs which link curvecast_operator_new.
/// FailedPrecondition where the folder takes no file.
absl::Status keep_memory_within(std::uint64_t bytes, const std::string& folder);

inline constexpr std::size_t kLeastSpill = std::size_t{256} << 10;

struct SpillUsage {
  std::uint64_t bytes = 0;  // of blocks that lie in the file
  std::uint64_t peak = 0;   // at most, so far
};
SpillUsage spill_usage();

/// For `operator new`. Returns a block of the file, or null where there is room in memory; throws SpillError. Preconditions:
/// bytes >= kLeastSpill; `alignment` is a power of two.
void* allocate_spilled(std::size_t bytes, std::size_t alignment);
/// For `operator new` and `operator delete`: blocks of kLeastSpill and more that have come into memory (+), or leave it (-).
void count_large_block(std::int64_t bytes) noexcept;
/// For `operator delete`. False where the block is not one of the file.
bool free_spilled(void* block) noexcept;

}  // namespace curvecast
