#include "tests/support/counted_memory.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::ptrdiff_t> in_use = 0;
std::atomic<std::ptrdiff_t> most_in_use = 0;
std::ptrdiff_t at_beginning = 0;

void* taken(void* memory) {
  if (memory == nullptr) return nullptr;
  const auto bytes = static_cast<std::ptrdiff_t>(malloc_usable_size(memory));
  const std::ptrdiff_t now = in_use += bytes;
  std::ptrdiff_t most = most_in_use;
  while (now > most && !most_in_use.compare_exchange_weak(most, now)) {
  }
  return memory;
}

void* taken_or_throw(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  return taken(memory);
}

void give_back(void* memory) {
  if (memory == nullptr) return;
  in_use -= static_cast<std::ptrdiff_t>(malloc_usable_size(memory));
  std::free(memory);
}

void* aligned(std::size_t size, std::align_val_t alignment) {
  const auto step = static_cast<std::size_t>(alignment);
  return std::aligned_alloc(step, (size + step - 1) / step * step);
}

}  // namespace

// The forms for arrays call these; so do those that throw nothing, but not AddressSanitizer's.
void* operator new(std::size_t size) { return taken_or_throw(std::malloc(size)); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return taken(std::malloc(size)); }
void* operator new(std::size_t size, std::align_val_t alignment) { return taken_or_throw(aligned(size, alignment)); }
void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return taken(aligned(size, alignment));
}
void operator delete(void* memory) noexcept { give_back(memory); }
void operator delete(void* memory, std::size_t) noexcept { give_back(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { give_back(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { give_back(memory); }

namespace curvecast::testing {

CountedMemory::CountedMemory() {
  at_beginning = in_use;
  most_in_use = at_beginning;
}

std::size_t CountedMemory::peak() const { return static_cast<std::size_t>(most_in_use - at_beginning); }

}  // namespace curvecast::testing
