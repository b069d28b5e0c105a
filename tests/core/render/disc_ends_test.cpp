#include "core/render/disc_ends.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace curvecast {
namespace {

constexpr float kStep = 0.1F, kRadius = 0.1F;

using Vec3 = std::array<float, 3>;

SplatVertex splat(const Vec3& at, const Vec3& normal, float radius = kRadius) { return {at, radius, normal, {}}; }

bool is_drawn(const SplatVertex& splat, const Vec3& p) {
  for (const auto& [x, y, z, w] : splat.ends) {
    if (x * p[0] + y * p[1] + z * p[2] > w) return false;
  }
  return true;
}

bool has_end(const SplatVertex& splat) { return splat.ends != SplatVertex{}.ends; }

/// Finds the ends as an eye sees them that looks from far away, in this direction from the splats.
void find_ends_from(const Vec3& direction, std::vector<SplatVertex>& splats, double degrees = 40) {
  const auto shift = [&](float way) {
    for (SplatVertex& s : splats) {
      for (std::size_t k = 0; k < 3; ++k) s.center[k] += way * direction[k];
    }
  };
  shift(-64);
  find_disc_ends(splats, degrees);
  shift(64);
  for (SplatVertex& s : splats) {
    for (auto& [x, y, z, w] : s.ends) w += 64 * (x * direction[0] + y * direction[1] + z * direction[2]);
  }
}

/// Points on the half planes z = 0, x < 0 and x = 0, z < 0, which meet at a ridge, or z > 0: in a valley.
std::vector<SplatVertex> bent(bool is_ridge) {
  std::vector<SplatVertex> splats;
  for (int i = 0; i < 10; ++i) {
    for (int j = -5; j < 5; ++j) {
      const float away = (static_cast<float>(i) + 0.5F) * kStep, along = static_cast<float>(j) * kStep;
      splats.push_back(splat({-away, along, 0}, {0, 0, 1}));
      splats.push_back(splat({0, along, is_ridge ? -away : away}, {is_ridge ? 1.0F : -1.0F, 0, 0}));
    }
  }
  return splats;
}

TEST(DiscEnds, DiscsEndAtRidgesAndValleys) {
  for (const bool is_ridge : {true, false}) {
    std::vector<SplatVertex> splats = bent(is_ridge);
    find_ends_from({is_ridge ? 1.0F : -1.0F, 0.2F, 1}, splats);
    for (const SplatVertex& s : splats) {
      EXPECT_TRUE(is_drawn(s, s.center)) << "its middle";
      const bool is_flat = s.normal[2] > 0.5F;
      const float away = is_flat ? -s.center[0] : std::abs(s.center[2]);
      if (away > 0.9F) continue;  // at the border of what there is
      EXPECT_EQ(has_end(s), away < 1.4F * kRadius) << away;
      if (!has_end(s)) continue;
      const float outwards = is_ridge ? 1.0F : -1.0F;
      const Vec3 beyond = is_flat ? Vec3{0.01F, s.center[1], 0} : Vec3{0, s.center[1], outwards * 0.01F};
      const Vec3 before = is_flat ? Vec3{-0.01F, s.center[1], 0} : Vec3{0, s.center[1], outwards * -0.01F};
      EXPECT_FALSE(is_drawn(s, beyond));
      EXPECT_TRUE(is_drawn(s, before));
    }
  }
}

TEST(DiscEnds, CreasesBeginAtTheAngleThatIsAskedFor) {
  const auto ends = [](double turn, double degrees) {
    const auto cosine = static_cast<float>(std::cos(turn * M_PI / 180)), sine = static_cast<float>(std::sin(turn * M_PI / 180));
    std::vector<SplatVertex> splats;
    for (int i = 0; i < 10; ++i) {
      for (int j = -5; j < 5; ++j) {
        const float away = (static_cast<float>(i) + 0.5F) * kStep, along = static_cast<float>(j) * kStep;
        splats.push_back(splat({-away, along, 0}, {0, 0, 1}));
        splats.push_back(splat({away * cosine, along, -away * sine}, {sine, 0, cosine}));
      }
    }
    find_ends_from({0, 0, 1}, splats, degrees);
    return std::count_if(splats.begin(), splats.end(), has_end);
  };
  for (const double turn : {10.0, 30.0, 90.0}) {
    SCOPED_TRACE(turn);
    EXPECT_GT(ends(turn, turn - 1), 0);
    EXPECT_EQ(ends(turn, turn - 1), ends(turn, 0));
  }
  for (const double turn : {10.0, 30.0}) EXPECT_LT(ends(turn, turn + 1), ends(turn, turn - 1)) << "some are at outlines";
  EXPECT_EQ(ends(3, 0), 0) << "normals are rounded";
}

TEST(DiscEnds, CornersHaveTwoLines) {
  std::vector<SplatVertex> splats;
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) {
      const float a = -(static_cast<float>(i) + 0.5F) * kStep, b = -(static_cast<float>(j) + 0.5F) * kStep;
      splats.push_back(splat({a, b, 0}, {0, 0, 1}));
      splats.push_back(splat({0, a, b}, {1, 0, 0}));
      splats.push_back(splat({b, 0, a}, {0, 1, 0}));
    }
  }
  find_ends_from({1, 1, 1}, splats);
  EXPECT_FALSE(is_drawn(splats[0], {0.01F, -0.05F, 0}));
  EXPECT_FALSE(is_drawn(splats[0], {-0.05F, 0.01F, 0}));
  EXPECT_TRUE(is_drawn(splats[0], {-0.01F, -0.01F, 0}));
}

TEST(DiscEnds, SmoothSurfacesAndThinSheetsHaveNone) {
  std::vector<SplatVertex> splats;
  for (int i = 0; i < 2000; ++i) {  // a ball, by the golden angle
    const float z = 1 - (2 * static_cast<float>(i) + 1) / 2000, r = std::sqrt(1 - z * z),
                angle = 2.399963F * static_cast<float>(i);
    const Vec3 p = {r * std::cos(angle), r * std::sin(angle), z};
    splats.push_back(splat(p, p, 0.08F));
  }
  for (int i = 0; i < 400; ++i) {
    const float x = 5 + kStep * static_cast<float>(i % 20), y = kStep * static_cast<float>(i / 20);
    splats.push_back(splat({x, y, 0}, {0, 0, 1}));
    splats.push_back(splat({x + 0.03F, y, -0.02F}, {0, 0, -1}));
  }
  find_ends_from({0, 0.3F, 1}, splats);
  for (const SplatVertex& s : splats) {
    const bool is_at_outline = std::abs(0.29F * s.normal[1] + 0.96F * s.normal[2]) < 0.5F;
    const auto is_inner = [](float x) { return x > 0.15F && x < 1.75F; };
    const bool is_at_border = s.center[0] > 2 && !(is_inner(s.center[0] - 5) && is_inner(s.center[1]));
    EXPECT_FALSE(has_end(s) && !is_at_outline && !is_at_border);
  }
}

TEST(DiscEnds, OddPointsAreHarmless) {
  std::vector<SplatVertex> none;
  find_disc_ends(none, 40);
  std::vector<SplatVertex> one = {splat({1, 2, 3}, {0, 0, 1})};
  find_disc_ends(one, 40);
  EXPECT_FALSE(has_end(one[0]));
  // At one place, without normals, without size, far away.
  std::vector<SplatVertex> many(50, splat({1, 2, 3}, {0, 0, 1}));
  for (int i = 0; i < 50; ++i) many.push_back(splat({1, 2, 3}, i % 2 == 0 ? Vec3{0, 1, 0} : Vec3{}, i % 3 == 0 ? 0 : 1e12F));
  many.push_back(splat({1e12F, 0, 0}, {1, 0, 0}));
  find_disc_ends(many, 40);
  for (const SplatVertex& s : many) EXPECT_FALSE(std::isnan(s.ends[0][3]) || std::isnan(s.ends[1][3]));
}

}  // namespace
}  // namespace curvecast
