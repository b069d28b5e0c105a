#include "core/base/column.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

#include <new>

namespace curvecast {
namespace {

constexpr std::size_t kLargePage = std::size_t{2} << 20;
constexpr std::align_val_t kCacheLine{64};

}  // namespace

std::shared_ptr<const void> allocate_pages(std::size_t bytes) {
  if (bytes == 0) return nullptr;
#ifdef __linux__
  if (bytes >= 2 * kLargePage) {
    constexpr std::align_val_t kAlignment{kLargePage};
    void* const memory = ::operator new(bytes, kAlignment);
    // The last page, of which only a part is used, stays small.
    ::madvise(memory, bytes / kLargePage * kLargePage, MADV_HUGEPAGE);
    return {memory, [](const void* p) { ::operator delete(const_cast<void*>(p), kAlignment); }};
  }
#endif
  return {::operator new(bytes, kCacheLine), [](const void* p) { ::operator delete(const_cast<void*>(p), kCacheLine); }};
}

}  // namespace curvecast
