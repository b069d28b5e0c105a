// Wakes a thread that waits in poll().
#pragma once

#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>

namespace curvecast::server {

/// Thread-safe. Once rung it stays so.
class WakeUp {
 public:
  /// Throws std::system_error where there is no descriptor left.
  WakeUp() : descriptor_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
  }
  WakeUp(const WakeUp&) = delete;
  WakeUp& operator=(const WakeUp&) = delete;
  ~WakeUp() { ::close(descriptor_); }

  void ring() const {
    const std::uint64_t once = 1;
    [[maybe_unused]] const ssize_t written = ::write(descriptor_, &once, sizeof once);  // fails only where it rings already
  }
  /// Readable once it was rung.
  int descriptor() const { return descriptor_; }

 private:
  const int descriptor_;
};

}  // namespace curvecast::server
