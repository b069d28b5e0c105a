// Measures what every input takes. More memory than a fuzzer is allowed is a finding, reported where it is asked for. Time is
// reported only: sanitised code is three to ten times slower than what users run, and a busy machine slower still, so that an
// input that is slow here has to be tried in a release build.
#include "tests/fuzz/fuzz_input.h"

#include <sanitizer/allocator_interface.h>
#include <time.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/fuzz/fuzz_expect.h"

namespace curvecast::fuzzing {
namespace {

constexpr std::ptrdiff_t kMostMemory = std::ptrdiff_t{CURVECAST_FUZZ_MEMORY} << 20;  // bytes that one input holds at a time
constexpr double kMostTime = 0.1;                                                    // seconds of all processors

std::atomic<bool> counts = false;
std::atomic<std::ptrdiff_t> held = 0, most_held = 0;  // by the input, beyond what was held before it

void on_allocated(const volatile void* /*memory*/, std::size_t size) {
  if (!counts.load(std::memory_order_relaxed)) return;
  const std::ptrdiff_t now = held += static_cast<std::ptrdiff_t>(size);
  std::ptrdiff_t most = most_held;
  while (now > most && !most_held.compare_exchange_weak(most, now)) {
  }
  // Not counting any more: the report allocates, too.
  if (now > kMostMemory && counts.exchange(false)) {
    expect(false,
           "the input holds " + std::to_string(now >> 20) + " MiB of memory, the last " + std::to_string(size) + " bytes here");
  }
}

void on_freed(const volatile void* memory) {
  if (counts.load(std::memory_order_relaxed)) held -= static_cast<std::ptrdiff_t>(__sanitizer_get_allocated_size(memory));
}

/// Of all inputs. Printed when the program ends, in the form that deploy/fuzz reads.
class Totals {
 public:
  Totals() { __sanitizer_install_malloc_and_free_hooks(on_allocated, on_freed); }
  Totals(const Totals&) = delete;
  ~Totals() {
    std::fprintf(stderr, "inputs: slow %d, slowest %.0f ms, most memory %.1f MiB\n", slow_, 1e3 * slowest_,
                 static_cast<double>(most_memory_) / (1 << 20));
  }

  void note(double seconds, const std::uint8_t* data, std::size_t size) {
    most_memory_ = std::max<std::ptrdiff_t>(most_memory_, most_held);
    if (seconds > kMostTime) ++slow_;
    if (seconds <= slowest_) return;
    slowest_ = seconds;
    if (const char* const path = std::getenv("CURVECAST_FUZZ_SLOWEST"); path != nullptr && seconds > kMostTime) {
      std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    }
  }

 private:
  int slow_ = 0;
  double slowest_ = 0;  // seconds
  std::ptrdiff_t most_memory_ = 0;
};

Totals totals;

}  // namespace

double processor_time() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace curvecast::fuzzing

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curvecast::fuzzing;
  held = most_held = 0;
  const double before = processor_time();
  counts = true;
  take_input(data, size);
  counts = false;
  totals.note(processor_time() - before, data, size);
  return 0;
}
