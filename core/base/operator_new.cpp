// `operator new` and `operator delete` of programs whose memory is bounded: see spill.h. The other forms, for arrays, with sizes
// and without exceptions, come down to these, as the standard has it.
#include <malloc.h>

#include <cstdint>
#include <cstdlib>
#include <new>

#include "core/base/spill.h"

namespace {

constexpr std::size_t kDefaultAlignment = __STDCPP_DEFAULT_NEW_ALIGNMENT__;

void* allocate(std::size_t bytes, std::size_t alignment) {
  if (bytes >= curvecast::kLeastSpill) {
    if (void* const block = curvecast::allocate_spilled(bytes, alignment)) return block;
  }
  for (;;) {
    void* block = nullptr;
    if (alignment <= kDefaultAlignment) {
      block = std::malloc(bytes == 0 ? 1 : bytes);
    } else if (::posix_memalign(&block, alignment, bytes) != 0) {
      block = nullptr;
    }
    if (block != nullptr) {
      if (const std::size_t usable = ::malloc_usable_size(block); usable >= curvecast::kLeastSpill) {
        curvecast::count_large_block(static_cast<std::int64_t>(usable));
      }
      return block;
    }
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

void release(void* block) noexcept {
  if (block == nullptr || curvecast::free_spilled(block)) return;
  if (const std::size_t usable = ::malloc_usable_size(block); usable >= curvecast::kLeastSpill) {
    curvecast::count_large_block(-static_cast<std::int64_t>(usable));
  }
  std::free(block);
}

}  // namespace

void* operator new(std::size_t bytes) { return allocate(bytes, kDefaultAlignment); }
void* operator new(std::size_t bytes, std::align_val_t alignment) { return allocate(bytes, static_cast<std::size_t>(alignment)); }
void operator delete(void* block) noexcept { release(block); }
void operator delete(void* block, std::size_t) noexcept { release(block); }
void operator delete(void* block, std::align_val_t) noexcept { release(block); }
void operator delete(void* block, std::size_t, std::align_val_t) noexcept { release(block); }
