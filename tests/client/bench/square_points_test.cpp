#include "client/bench/peers/square_points.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/measure/star_discrepancy.h"

namespace curvecast::cli::bench {
namespace {

using ::testing::ElementsAre;

TEST(NiederreiterPoints, BeginAsTheBookHasThem) {
  EXPECT_THAT(niederreiter_points(5),
              ElementsAre(Vec2d(0, 0), Vec2d(0.5, 0.5), Vec2d(0.25, 0.75), Vec2d(0.75, 0.25), Vec2d(0.125, 0.625)));
}

TEST(NiederreiterPoints, LieOneInEachElementaryInterval) {
  // A (0, 2)-sequence: of every 2^m points from a multiple on, one in each box of 2^-a by 2^-(m - a).
  constexpr int kBits = 8;
  const std::vector<Vec2d> points = niederreiter_points(4 << kBits);
  for (int run = 0; run < 4; ++run) {
    for (int a = 0; a <= kBits; ++a) {
      std::set<std::pair<int, int>> boxes;
      for (int i = run << kBits; i < (run + 1) << kBits; ++i) {
        const Vec2d& p = points[static_cast<std::size_t>(i)];
        boxes.emplace(static_cast<int>(std::ldexp(p.x(), a)), static_cast<int>(std::ldexp(p.y(), kBits - a)));
      }
      ASSERT_EQ(boxes.size(), std::size_t{1} << kBits) << run << " " << a;
    }
  }
}

TEST(HammersleyPoints, AreEvenAlongXAndMirroredAlongY) {
  EXPECT_THAT(hammersley_points(4), ElementsAre(Vec2d(0, 0), Vec2d(0.25, 0.5), Vec2d(0.5, 0.25), Vec2d(0.75, 0.75)));
  EXPECT_TRUE(hammersley_points(0).empty());
}

TEST(SquarePoints, HaveALowDiscrepancy) {
  for (const std::size_t n : {100u, 1000u, 3000u}) {
    const double bound = 3 * (std::log2(static_cast<double>(n)) / 3 + 3) / static_cast<double>(n);
    EXPECT_LT(star_discrepancy(niederreiter_points(n)), bound) << n;
    EXPECT_LT(star_discrepancy(hammersley_points(n)), bound) << n;
  }
}

}  // namespace
}  // namespace curvecast::cli::bench
