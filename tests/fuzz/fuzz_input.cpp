// Measures what every input takes. More memory than a fuzzer is allowed is a finding, reported where it is asked for: with
// AddressSanitizer its hooks tell of that, else the functions that programs call instead of glibc's. Time is reported only:
// sanitised code is three to ten times slower than what users run, and a busy machine slower still, so that an input that is slow
// here has to be tried in a release build.
#include "tests/fuzz/fuzz_input.h"

#include <time.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/fuzz/fuzz_expect.h"

#if __has_feature(address_sanitizer)
#include <sanitizer/allocator_interface.h>
#define CURVECAST_HAS_ALLOCATION_HOOKS 1
#else
#include <errno.h>
#include <malloc.h>
#define CURVECAST_HAS_ALLOCATION_HOOKS 0
#endif

namespace curvecast::fuzzing {
namespace {

constexpr std::ptrdiff_t kMostMemory = std::ptrdiff_t{CURVECAST_FUZZ_MEMORY} << 20;  // bytes that one input holds at a time
constexpr double kMostTime = 0.1;                                                    // seconds of all processors

std::atomic<bool> counts = false;
std::atomic<std::ptrdiff_t> held = 0, most_held = 0;  // by the input, beyond what was held before it

void on_allocated(std::size_t size) {
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

void on_freed(std::size_t size) {
  if (counts.load(std::memory_order_relaxed)) held -= static_cast<std::ptrdiff_t>(size);
}

/// Of all inputs. Printed when the program ends, in the form that deploy/fuzz reads.
class Totals {
 public:
  Totals() {
#if CURVECAST_HAS_ALLOCATION_HOOKS
    __sanitizer_install_malloc_and_free_hooks(
        [](const volatile void* /*memory*/, std::size_t size) { on_allocated(size); },
        [](const volatile void* memory) { on_freed(__sanitizer_get_allocated_size(memory)); });
#endif
  }
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

#if !CURVECAST_HAS_ALLOCATION_HOOKS
// In place of glibc's functions, and by them.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);

namespace {

void* counted(void* memory) {
  if (memory != nullptr) curvecast::fuzzing::on_allocated(malloc_usable_size(memory));
  return memory;
}

}  // namespace

void* malloc(std::size_t size) { return counted(__libc_malloc(size)); }
void* calloc(std::size_t count, std::size_t size) { return counted(__libc_calloc(count, size)); }
void* realloc(void* memory, std::size_t size) {
  const std::size_t before = malloc_usable_size(memory);
  void* const grown = __libc_realloc(memory, size);
  if (grown != nullptr || size == 0) curvecast::fuzzing::on_freed(before);
  return counted(grown);
}
void* memalign(std::size_t alignment, std::size_t size) { return counted(__libc_memalign(alignment, size)); }
void* aligned_alloc(std::size_t alignment, std::size_t size) { return counted(__libc_memalign(alignment, size)); }
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  *memory = counted(__libc_memalign(alignment, size));
  return *memory != nullptr ? 0 : ENOMEM;
}
void free(void* memory) {
  curvecast::fuzzing::on_freed(malloc_usable_size(memory));
  __libc_free(memory);
}
}
#endif

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
