#include "core/progressive/point_energy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/base/vec.h"

namespace curvecast {
namespace {

const std::vector<Vec3f> kPositions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 3, 4}};

TEST(PointEnergy, FallsWithTheDistance) {
  PointEnergy energy(kPositions, 2);
  energy.add(kPositions[0].data());
  EXPECT_FLOAT_EQ(energy.excess(0, 0), 1);
  EXPECT_FLOAT_EQ(energy.excess(1, 0), 0.25f);
  EXPECT_EQ(energy.excess(2, 0), 0);
  EXPECT_EQ(energy.excess(3, 0), 0);
  energy.add(kPositions[1].data());
  EXPECT_FLOAT_EQ(energy.excess(0, 0), 1.25f);
}

TEST(PointEnergy, IsOverWhatIsExpected) {
  PointEnergy energy(kPositions, 2.5f);
  for (const Vec3f& p : kPositions) energy.expect(p.data());
  EXPECT_LT(energy.excess(1, 0.5f), 0);
  for (const Vec3f& p : kPositions) energy.add(p.data());
  for (std::size_t i = 0; i < energy.size(); ++i) EXPECT_FLOAT_EQ(energy.excess(i, 1), 0);
}

/// The energy of any distribution whose masses add up to nothing is positive, as it is for sums of distances: even is least.
TEST(PointEnergy, IsAnEnergyThatIsLeastWhenEven) {
  constexpr int kSide = 12;
  std::vector<Vec3f> grid;
  for (int i = 0; i < kSide * kSide; ++i) grid.emplace_back(static_cast<float>(i % kSide), static_cast<float>(i / kSide), 0.0f);
  for (const int wave : {1, 2, 3, 6}) {
    double total = 0;
    for (const Vec3f& from : grid) {
      PointEnergy energy(grid, 4);
      energy.add(from.data());
      for (std::size_t i = 0; i < grid.size(); ++i) {
        total += std::cos(wave * from.x()) * std::cos(wave * grid[i].x()) * double{energy.excess(i, 0)};
      }
    }
    EXPECT_GT(total, 0) << wave;
  }
}

}  // namespace
}  // namespace curvecast
