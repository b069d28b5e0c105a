#include "core/progressive/sort_along_curve.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace curvecast {

void sort_along_curve(std::vector<std::uint64_t>& keys, std::vector<std::uint64_t>& scratch) {
  // The upper digits leave next to nothing to do for the insertion sort. Points of a near view have the first digits in common.
  constexpr int kPasses = 2, kBits = 11;
  constexpr std::size_t kBins = std::size_t{1} << kBits;
  std::uint64_t differing = 0;
  for (const std::uint64_t key : keys) differing |= key ^ keys.front();
  const int lowest = std::max(static_cast<int>(std::bit_width(differing >> kIndexBits)) - kPasses * kBits, 0) + kIndexBits;
  std::array<std::array<std::uint32_t, kBins>, kPasses> begin{};
  const auto bin = [lowest](std::uint64_t key, int pass) { return key >> (lowest + pass * kBits) & (kBins - 1); };
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
  // Runs with the same upper digits are short for positions on a curve; for any others this stays correct.
  constexpr std::size_t kShort = 32;
  const auto same_bins = [lowest](std::uint64_t a, std::uint64_t b) { return a >> lowest == b >> lowest; };
  const auto before = [](std::uint64_t a, std::uint64_t b) { return a >> kIndexBits < b >> kIndexBits; };
  for (std::size_t first = 0; first < keys.size();) {
    std::size_t end = first + 1;
    while (end < keys.size() && same_bins(keys[first], keys[end])) ++end;
    if (end - first > kShort) {
      std::stable_sort(keys.begin() + static_cast<std::ptrdiff_t>(first), keys.begin() + static_cast<std::ptrdiff_t>(end),
                       before);
    } else {
      for (std::size_t i = first + 1; i < end; ++i) {
        for (std::size_t k = i; k > first && before(keys[k], keys[k - 1]); --k) std::swap(keys[k], keys[k - 1]);
      }
    }
    first = end;
  }
}

}  // namespace curvecast
