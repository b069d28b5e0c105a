// Vectors that begin with a line of the processor's caches.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace curvecast {

inline constexpr std::size_t kCacheLine = 64;  // bytes

template <typename T>
struct CacheLineAllocator {
  using value_type = T;

  CacheLineAllocator() = default;
  template <typename U>
  CacheLineAllocator(const CacheLineAllocator<U>&) {}  // NOLINT(google-explicit-constructor): what allocators are asked for
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new (n * sizeof(T), std::align_val_t{kCacheLine})); }
  void deallocate(T* block, std::size_t) noexcept { ::operator delete (block, std::align_val_t{kCacheLine}); }
  bool operator==(const CacheLineAllocator&) const { return true; }
};

/// For columns of which short runs are read here and there: a run that fills lines takes no more lines than it has to.
template <typename T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

}  // namespace curvecast
