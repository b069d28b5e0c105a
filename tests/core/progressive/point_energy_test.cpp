#include "core/progressive/crowding.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/base/vec.h"

namespace curvecast {
namespace {

const std::vector<Vec3f> kPlacesInARow = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 3, 4}};

TEST(Crowding, FallsWithTheDistance) {
  Crowding crowding(kPlacesInARow, 2);
  crowding.add(kPlacesInARow[0].data());
  EXPECT_FLOAT_EQ(crowding.at(0, 0), 1);
  EXPECT_FLOAT_EQ(crowding.at(1, 0), 0.25f);
  EXPECT_EQ(crowding.at(2, 0), 0);
  EXPECT_EQ(crowding.at(3, 0), 0);
  crowding.add(kPlacesInARow[1].data());
  EXPECT_FLOAT_EQ(crowding.at(0, 0), 1.25f);
}

TEST(Crowding, IsOverWhatIsExpected) {
  Crowding crowding(kPlacesInARow, 2.5f);
  for (const Vec3f& p : kPlacesInARow) crowding.expect(p.data());
  EXPECT_LT(crowding.at(1, 0.5f), 0);
  for (const Vec3f& p : kPlacesInARow) crowding.add(p.data());
  for (std::size_t i = 0; i < crowding.size(); ++i) EXPECT_FLOAT_EQ(crowding.at(i, 1), 0);
}

/// As a sum of distances has it: an energy that is no less for any change of the masses.
TEST(Crowding, IsAnEnergyThatIsLeastWhenEven) {
  constexpr int kSide = 12;
  std::vector<Vec3f> grid;
  for (int i = 0; i < kSide * kSide; ++i) grid.emplace_back(static_cast<float>(i % kSide), static_cast<float>(i / kSide), 0.0f);
  for (const int wave : {1, 2, 3, 6}) {
    double energy = 0;
    for (const Vec3f& from : grid) {
      Crowding crowding(grid, 4);
      crowding.add(from.data());
      for (std::size_t i = 0; i < grid.size(); ++i) {
        energy += std::cos(wave * from.x()) * std::cos(wave * grid[i].x()) * double{crowding.at(i, 0)};
      }
    }
    EXPECT_GT(energy, 0) << wave;
  }
}

}  // namespace
}  // namespace curvecast
