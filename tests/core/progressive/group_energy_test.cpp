#include "core/progressive/group_energy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/core/progressive/flat_group.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

class GroupEnergyTest : public ::testing::Test {
 protected:
  const FlatCandidates flat_;
  const GroupCandidates& candidates_ = flat_.candidates;
  const std::vector<std::uint8_t> all_ = std::vector<std::uint8_t>(candidates_.size(), 1);

  /// The energy of a candidate, less that of an even distribution, point by point and place by place.
  double exact(std::size_t c, std::size_t k, const std::vector<RankedPoint>& points) const {
    const double range = 3.0 * static_cast<double>(lattice_distance(candidates_.total_area(), 64));
    const CandidatePoints& own = candidates_.in_child(c);
    const auto kernel = [&](float x, float y) {
      const double rest = 1 - std::hypot(static_cast<double>(own.x[k] - x), static_cast<double>(own.y[k] - y)) / range;
      return rest > 0 ? rest * rest : 0;
    };
    double sum = 0;
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (j != c) sum += kernel(points[j].position[0], points[j].position[1]);
      const CandidatePoints& places = candidates_.in_child(j);
      for (std::size_t i = 0; i < kCandidates; ++i) sum -= kernel(places.x[i], places.y[i]) / kCandidates;
    }
    return sum;
  }
};

TEST_F(GroupEnergyTest, IsAboutWhatItIsPointByPoint) {
  const std::vector<RankedPoint> points = points_at(candidates_, [](std::size_t c) { return (c * 37 + 11) % kCandidates; });
  const GroupEnergy energy(candidates_, all_);
  double error = 0, spread = 0;
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    const GroupEnergy::Row row = energy.of_candidates(c, points);
    std::array<double, kCandidates> want{};
    double shift = 0, mean = 0;
    for (std::size_t k = 0; k < kCandidates; ++k) {
      want[k] = exact(c, k, points);
      shift += (want[k] - static_cast<double>(row[k])) / kCandidates;
      mean += want[k] / kCandidates;
    }
    for (std::size_t k = 0; k < kCandidates; ++k) {
      error += std::pow(want[k] - shift - static_cast<double>(row[k]), 2);
      spread += std::pow(want[k] - mean, 2);
    }
  }
  EXPECT_LT(std::sqrt(error / spread), 0.35);
}

TEST_F(GroupEnergyTest, OfAPointDoesNotCountItself) {
  std::vector<RankedPoint> points = points_at(candidates_, [](std::size_t) { return std::size_t{5}; });
  const GroupEnergy energy(candidates_, all_);
  const GroupEnergy::Row before = energy.of_candidates(101, points);
  points[101] = candidates_.point(101, 30, points[101].rank);
  EXPECT_EQ(energy.of_candidates(101, points), before);
  points[102] = candidates_.point(102, 30, points[102].rank);
  EXPECT_NE(energy.of_candidates(101, points), before);
}

TEST_F(GroupEnergyTest, IsLeastAwayFromACrowd) {
  // The points of all other children lie as near to this one as they can.
  const std::size_t c = 136;
  const Vec3f& middle = candidates_.child(c).centre;
  const auto nearest = [&](std::size_t j) {
    const CandidatePoints& places = candidates_.in_child(j);
    std::size_t best = 0;
    const auto square = [&](std::size_t k) { return (Vec3f(places.x[k], places.y[k], places.z[k]) - middle).squaredNorm(); };
    for (std::size_t k = 1; k < kCandidates; ++k) best = square(k) < square(best) ? k : best;
    return best;
  };
  const float above = middle.y();
  // Only those above it: the least energy is below.
  const std::vector<RankedPoint> points = points_at(
      candidates_, [&](std::size_t j) { return candidates_.child(j).centre.y() > above ? nearest(j) : kCandidates / 2; });
  const GroupEnergy::Row row = GroupEnergy(candidates_, all_).of_candidates(c, points);
  const auto least = static_cast<std::size_t>(std::min_element(row.begin(), row.end()) - row.begin());
  EXPECT_LT(candidates_.in_child(c).y[least], above);
}

}  // namespace
}  // namespace curvecast
