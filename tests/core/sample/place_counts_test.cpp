#include "core/sample/place_counts.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/sample/random.h"

namespace curvecast {
namespace {

/// Places of which all but a few lie in a part of the range.
std::vector<std::uint32_t> some_places(std::uint64_t seed, std::size_t count, double low, double high) {
  std::vector<std::uint32_t> places;
  for (std::size_t i = 0; i < count; ++i) {
    const double from = i % 50 == 0 ? 0 : low, to = i % 50 == 0 ? 1 : high;
    places.push_back(static_cast<std::uint32_t>((from + (to - from) * random_unit(seed, i)) * 0xffffffffp0));
  }
  return places;
}

TEST(PlaceCounts, CountWhatASortedListTells) {
  PlaceCounts counts;
  std::uint64_t seed = 0;
  for (const std::size_t n : {0, 1, 2, 100, 30'000, 5}) {
    for (const auto& [low, high] : {std::pair(0.0, 1.0), std::pair(0.5, 0.5001), std::pair(0.25, 0.25)}) {
      const std::vector<std::uint32_t> places = some_places(++seed, n, low, high);
      std::vector<std::uint32_t> queries = some_places(++seed, n / 2 + 3, low, high);
      queries.insert(queries.end(), places.begin(), places.begin() + static_cast<std::ptrdiff_t>(n / 3));
      queries.insert(queries.end(), {0, 0xffffffffu});
      std::vector<std::uint32_t> below(queries.size()), sorted = places;
      counts.count_below(places, queries, below);
      std::ranges::sort(sorted);
      for (std::size_t i = 0; i < queries.size(); ++i) {
        ASSERT_EQ(below[i], std::ranges::lower_bound(sorted, queries[i]) - sorted.begin())
            << n << " places, query " << queries[i];
      }
    }
  }
}

}  // namespace
}  // namespace curvecast
