// Where a test program was when a signal ended it: CTest tells no more than which signal, and it may not happen again.
#include <absl/debugging/failure_signal_handler.h>
#include <absl/debugging/stacktrace.h>
#include <absl/debugging/symbolize.h>
#include <errno.h>
#include <execinfo.h>

#include <algorithm>
#include <array>
#include <csignal>

namespace {

/// By the tables that exceptions need, for there are no frame pointers.
int unwind(void** frames, int* sizes, int most, int skip, const void* /*context*/, int* dropped) {
  std::array<void*, 128> all = {};
  const int count = ::backtrace(all.data(), static_cast<int>(all.size()));
  const int first = std::min(skip + 1, count), taken = std::min(most, count - first);
  std::copy_n(all.begin() + first, taken, frames);
  if (sizes != nullptr) std::fill_n(sizes, taken, 0);
  if (dropped != nullptr) *dropped = count - first - taken;
  return taken;
}

const bool is_installed = [] {
  void* here = nullptr;
  ::backtrace(&here, 1);  // loads what it needs, which a handler must not
  absl::SetStackUnwinder(unwind);
  absl::InitializeSymbolizer(program_invocation_name);
  absl::InstallFailureSignalHandler({.call_previous_handler = true});
  return std::signal(SIGTERM, SIG_DFL) != SIG_ERR;  // whoever ends it so knows why
}();

}  // namespace
