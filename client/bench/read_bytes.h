// The least that looking at an array can cost.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/simd.h"

namespace curvecast::cli::bench {

/// Reads a column as fast as the memory gives it. The result only keeps the compiler from leaving that out.
template <typename Column>
std::uint64_t read_bytes(const Column& column) {
  using Words = std::uint64_t __attribute__((vector_size(16)));
  const auto* const bytes = reinterpret_cast<const char*>(column.data());
  const std::size_t n = column.size() * sizeof(column[0]);
  Words a = {}, b = {}, c = {}, d = {};
  for (std::size_t i = 0; i + 4 * sizeof(Words) <= n; i += 4 * sizeof(Words)) {
    Words word;
    load_lanes(word, bytes + i), a ^= word;
    load_lanes(word, bytes + i + sizeof(Words)), b ^= word;
    load_lanes(word, bytes + i + 2 * sizeof(Words)), c ^= word;
    load_lanes(word, bytes + i + 3 * sizeof(Words)), d ^= word;
  }
  a ^= b ^ c ^ d;
  return a[0] ^ a[1];
}

}  // namespace curvecast::cli::bench
