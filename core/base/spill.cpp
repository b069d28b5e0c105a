#include "core/base/spill.h"

#include <absl/strings/str_cat.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <thread>

#include "core/base/mutex.h"
#include "core/base/unnamed_file.h"

namespace curvecast {
namespace {

constexpr double kRoom = 0.6;  // of the bound, for large blocks in memory: the rest is for small ones, files, and pages in use
constexpr std::size_t kAlignment = std::size_t{2} << 20;      // of the range
constexpr std::uint64_t kMostRange = std::uint64_t{1} << 42;  // addresses, not memory
constexpr std::uint64_t kLeastRange = std::uint64_t{1} << 32;
constexpr double kTrim = 0.85;  // of the bound, from which on pages are given back
constexpr double kAhead = 8;    // times what the process has grown by since it was looked at: to give back takes its time
constexpr auto kWatch = std::chrono::milliseconds(1), kWatchIdle = std::chrono::milliseconds(20);

std::size_t page_size() {
  static const auto kSize = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  return kSize;
}

std::size_t round_up(std::size_t n, std::size_t to) { return (n + to - 1) / to * to; }

/// What this process has in memory, of files too.
class ResidentBytes {
 public:
  std::int64_t operator()() const {
    char line[128] = {};
    if (::pread(file_, line, sizeof(line) - 1, 0) <= 0) return 0;
    const char* const second = std::strchr(line, ' ');
    return second == nullptr ? 0 : std::strtoll(second, nullptr, 10) * static_cast<std::int64_t>(page_size());
  }

 private:
  const int file_ = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
};

/// The blocks of a file, each at its own place in one range of addresses. Lives as long as the process.
class Spill {
 public:
  Spill(int file, char* begin, std::size_t size) : file_(file), begin_(begin), size_(size) { free_[0] = size; }

  bool holds(const void* block) const { return block >= begin_ && block < begin_ + size_; }

  void* allocate(std::size_t bytes, std::size_t alignment) {
    bytes = round_up(bytes, page_size());
    const std::size_t at = take(bytes, std::max(alignment, page_size()));
    // Now, not when the disk turns out to be full as a page is written: that would end the process.
    if (const int error = ::posix_fallocate(file_, static_cast<off_t>(at), static_cast<off_t>(bytes)); error != 0) {
      give_back(at);
      throw SpillError("the disk is full: the cache folder, or that for temporary files, holds what --memory leaves no room for");
    }
    void* const block = ::mmap(begin_ + at, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file_, static_cast<off_t>(at));
    if (block == MAP_FAILED) {
      give_back(at);
      throw SpillError("the system maps no more blocks of files: raise vm.max_map_count, or --memory");
    }
    return block;
  }

  void release(void* block) noexcept { give_back(static_cast<std::size_t>(static_cast<char*>(block) - begin_)); }

  /// The pages stay in the system's cache, or go to the disk; who touches them gets them again.
  void trim() const { ::madvise(begin_, size_, MADV_DONTNEED); }

  SpillUsage usage() const { return {bytes_.load(std::memory_order_relaxed), peak_.load(std::memory_order_relaxed)}; }

 private:
  std::size_t take(std::size_t bytes, std::size_t alignment) {
    const MutexLock lock(mutex_);
    for (auto it = free_.begin(); it != free_.end(); ++it) {
      const auto [begin, end] = *it;
      const std::size_t at = round_up(begin, alignment);
      if (at > end || end - at < bytes) continue;
      free_.erase(it);
      if (begin < at) free_[begin] = at;
      if (at + bytes < end) free_[at + bytes] = end;
      blocks_[at] = at + bytes;
      bytes_ += bytes;
      peak_ = std::max(peak_.load(), bytes_.load());
      return at;
    }
    throw SpillError("too many large blocks beyond --memory");
  }

  void give_back(std::size_t at) noexcept {
    MutexLock lock(mutex_);
    const auto block = blocks_.find(at);
    std::size_t begin = at, end = block->second;
    blocks_.erase(block);
    lock.unlock();  // to give back gigabytes takes its time
    (void)::mmap(begin_ + begin, end - begin, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED, -1, 0);
    ::fallocate(file_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(begin), static_cast<off_t>(end - begin));
    bytes_ -= end - begin;
    lock.lock();
    auto after = free_.lower_bound(begin);
    if (after != free_.end() && after->first == end) {
      end = after->second;
      after = free_.erase(after);
    }
    if (after != free_.begin() && std::prev(after)->second == begin) {
      std::prev(after)->second = end;
    } else {
      free_[begin] = end;
    }
  }

  const int file_;
  char* const begin_;
  const std::size_t size_;
  mutable Mutex mutex_;
  std::map<std::size_t, std::size_t> free_ ABSL_GUARDED_BY(mutex_);    // from begin to end
  std::map<std::size_t, std::size_t> blocks_ ABSL_GUARDED_BY(mutex_);  // from begin to end
  std::atomic<std::uint64_t> bytes_ = 0, peak_ = 0;                    // see SpillUsage
};

std::atomic<Spill*> the_spill = nullptr;  // never deleted: blocks of it may outlive everything
std::atomic<std::uint64_t> the_bound = 0;
std::atomic<std::int64_t> large_in_memory = 0;

/// Gives pages back before the process takes more than it may, as far as its growth can be foreseen.
[[noreturn]] void watch(const Spill* spill) {
  const ResidentBytes resident_bytes;
  std::int64_t before = 0;
  for (;;) {
    const bool is_idle = spill->usage().bytes == 0;
    std::this_thread::sleep_for(is_idle ? kWatchIdle : kWatch);
    if (is_idle) continue;
    const std::int64_t now = resident_bytes();
    const double ahead = kAhead * static_cast<double>(std::max(now - before, std::int64_t{0}));
    if (static_cast<double>(now) + ahead > kTrim * static_cast<double>(the_bound.load())) spill->trim();
    before = resident_bytes();
  }
}

absl::Status start(const std::string& folder) {
  const int file = open_unnamed_file(folder);
  if (file < 0) {
    return absl::FailedPreconditionError(absl::StrCat(folder, ": no room for what memory cannot hold: ", std::strerror(errno)));
  }
  for (std::uint64_t size = kMostRange; size >= kLeastRange; size /= 2) {
    void* const range = ::mmap(nullptr, size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (range == MAP_FAILED) continue;  // where addresses are limited
    const auto address = reinterpret_cast<std::uintptr_t>(range);
    const std::size_t skip = round_up(address, kAlignment) - address;
    auto* const spill = new Spill(file, static_cast<char*>(range) + skip, size - kAlignment);
    std::thread(watch, spill).detach();
    the_spill = spill;
    return absl::OkStatus();
  }
  ::close(file);
  return absl::FailedPreconditionError("the system gives this process too few addresses to keep large blocks in a file");
}

}  // namespace

absl::Status keep_memory_within(std::uint64_t bytes, const std::string& folder) {
  static Mutex mutex;
  const MutexLock lock(mutex);
  the_bound = bytes;
  return the_spill == nullptr ? start(folder) : absl::OkStatus();
}

SpillUsage spill_usage() {
  const Spill* const spill = the_spill;
  return spill == nullptr ? SpillUsage() : spill->usage();
}

void* allocate_spilled(std::size_t bytes, std::size_t alignment) {
  Spill* const spill = the_spill.load(std::memory_order_acquire);
  if (spill == nullptr) return nullptr;
  const double wanted = static_cast<double>(large_in_memory.load(std::memory_order_relaxed)) + static_cast<double>(bytes);
  if (wanted <= kRoom * static_cast<double>(the_bound.load(std::memory_order_relaxed))) return nullptr;
  return spill->allocate(bytes, alignment);
}

void count_large_block(std::int64_t bytes) noexcept { large_in_memory.fetch_add(bytes, std::memory_order_relaxed); }

bool free_spilled(void* block) noexcept {
  Spill* const spill = the_spill.load(std::memory_order_acquire);
  if (spill == nullptr || !spill->holds(block)) return false;
  spill->release(block);
  return true;
}

}  // namespace curvecast
