#include "core/measure/nearest_lists.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "core/base/random.h"

namespace curvecast {
namespace {

/// Offers points, some as far as others, and expects the first k in order.
template <typename List>
void expect_first(List list, std::size_t k, std::size_t offers, std::vector<Neighbour>& found) {
  std::vector<Neighbour> truth;
  for (std::uint32_t i = 0; i < offers; ++i) {
    const auto square = static_cast<float>(static_cast<int>(20 * random_unit(offers, i)));
    truth.push_back({static_cast<std::uint32_t>(offers) - i, square});
    list.offer(truth.back());
  }
  std::sort(truth.begin(), truth.end(),
            [](const Neighbour& a, const Neighbour& b) { return std::tie(a.square, a.index) < std::tie(b.square, b.index); });
  truth.resize(k);
  list.write(found);
  EXPECT_EQ(found, truth) << k << " of " << offers;
  EXPECT_EQ(list.limit(), offers < k ? kFarthest : truth.back().square);
}

TEST(NearestLists, KeepTheFirstOfWhatTheyAreOffered) {
  for (const std::size_t offers : {0, 1, 5, 16, 100}) {
    for (std::size_t k = 1; k <= 20; ++k) {
      std::vector<Neighbour> found(k);
      expect_first(NearestMany(found), k, offers, found);
      if (k == 1) expect_first(NearestOne(), k, offers, found);
      if (k <= 8) expect_first(NearestFew<8>(k), k, offers, found);
      if (k <= 16) expect_first(NearestFew<16>(k), k, offers, found);
    }
  }
}

}  // namespace
}  // namespace curvecast
