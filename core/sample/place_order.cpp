#include "core/sample/place_order.h"

#include <array>

namespace curvecast {

void sort_by_place(std::vector<std::uint64_t>& keys, std::vector<std::uint64_t>& scratch) {
  constexpr int kPlace = 32, kPasses = 3, kBits = 11;
  constexpr std::size_t kBins = std::size_t{1} << kBits;
  std::array<std::array<std::uint32_t, kBins>, kPasses> begin{};
  const auto bin = [](std::uint64_t key, int pass) { return key >> (kPlace + pass * kBits) & (kBins - 1); };
  for (const std::uint64_t key : keys) {
    for (int pass = 0; pass < kPasses; ++pass) ++begin[static_cast<std::size_t>(pass)][bin(key, pass)];
  }
  scratch.resize(keys.size());
  for (int pass = 0; pass < kPasses; ++pass) {
    auto& to = begin[static_cast<std::size_t>(pass)];
    std::uint32_t sum = 0;
    for (std::uint32_t& count : to) {
      const std::uint32_t before = sum;
      sum += count;
      count = before;
    }
    for (const std::uint64_t key : keys) scratch[to[bin(key, pass)]++] = key;
    keys.swap(scratch);
  }
}

}  // namespace curvecast
