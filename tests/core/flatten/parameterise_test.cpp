#include "core/flatten/parameterise.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <set>
#include <thread>

#include "core/flatten/cut_to_disc.h"
#include "core/flatten/distortion.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

DiscMesh disc_of(const PolygonSoup& soup) {
  absl::StatusOr<DiscMesh> disc = cut_to_disc(testing::make_mesh(soup));
  EXPECT_TRUE(disc.ok());
  return *std::move(disc);
}

std::vector<DiscMesh> discs() {
  using namespace testing;
  return {disc_of(disc(8, 24)),           disc_of(jittered(sphere(20, 30), 0.02)), disc_of(torus(24, 12)),
          disc_of(perforated_slab(5, 5)), disc_of(open_cylinder(12, 16)),          disc_of(single_triangle()),
          disc_of(tetrahedron())};
}

TEST(Parameterise, CoversTheSquareOnceWithoutAFlip) {
  for (const DiscMesh& disc : discs()) {
    for (const ParameterWeights weights : {ParameterWeights::kMeanValue, ParameterWeights::kUniform}) {
      const auto uv = parameterise(disc, {.weights = weights});
      ASSERT_TRUE(uv.ok()) << uv.status().message();
      EXPECT_EQ(count_flipped(disc, *uv), 0u);
      double area = 0;
      for (const Triangle& t : disc.triangles) {
        const Vec2d p = (*uv)[t[1]] - (*uv)[t[0]], q = (*uv)[t[2]] - (*uv)[t[0]];
        area += 0.5 * (p.x() * q.y() - p.y() * q.x());
      }
      EXPECT_NEAR(area, 1, 1e-12);  // with no flip and the border once around, this makes it one-to-one
    }
  }
}

TEST(Parameterise, BorderRunsAroundTheSquareWithACornerAtEachOfItsCorners) {
  for (const DiscMesh& disc : discs()) {
    const auto uv = parameterise(disc);
    ASSERT_TRUE(uv.ok());
    std::set<std::pair<double, double>> corners;
    double length = 0;
    for (std::size_t i = 0; i < disc.border.size(); ++i) {
      const Vec2d& p = (*uv)[disc.border[i]];
      EXPECT_TRUE(p.x() == 0 || p.x() == 1 || p.y() == 0 || p.y() == 1);
      if ((p.x() == 0 || p.x() == 1) && (p.y() == 0 || p.y() == 1)) corners.insert({p.x(), p.y()});
      length += (p - (*uv)[disc.border[(i + 1) % disc.border.size()]]).norm();
    }
    EXPECT_EQ(corners.size(), 4u);
    EXPECT_NEAR(length, 4, 1e-12);
  }
}

TEST(Parameterise, InnerVerticesAreMeanValuesOfTheirNeighbours) {
  const DiscMesh disc = disc_of(testing::jittered(testing::disc(8, 24), 0.02));
  const auto uv = parameterise(disc, {.reweightings = 0});
  ASSERT_TRUE(uv.ok());
  // Floater (2003), equation 2.1, with the angles from acos.
  std::vector<Vec2d> sum(disc.vertex_count(), Vec2d::Zero());
  std::vector<double> weight(disc.vertex_count(), 0.0);
  for (const Triangle& t : disc.triangles) {
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3], c = t[(i + 2) % 3];
      const Vec3d u = disc.positions[b] - disc.positions[a], v = disc.positions[c] - disc.positions[a];
      const double half = std::tan(0.5 * std::acos(u.dot(v) / (u.norm() * v.norm())));
      sum[a] += half / u.norm() * (*uv)[b] + half / v.norm() * (*uv)[c];
      weight[a] += half / u.norm() + half / v.norm();
    }
  }
  const std::set<std::uint32_t> border(disc.border.begin(), disc.border.end());
  for (std::uint32_t v = 0; v < disc.vertex_count(); ++v) {
    if (border.contains(v)) continue;
    EXPECT_LT((sum[v] / weight[v] - (*uv)[v]).norm(), 1e-12);
  }
}

TEST(Parameterise, ReproducesAFlatSquare) {
  // Mean value coordinates reproduce linear maps: a flat square with its border in place maps to itself.
  DiscMesh disc;
  constexpr int kSide = 9;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const bool inner = x > 0 && y > 0 && x + 1 < kSide && y + 1 < kSide;
      const double shift = inner ? 0.3 * std::sin(7.0 * x + 3.0 * y) : 0;
      disc.positions.emplace_back((x + shift) / (kSide - 1), (y - shift) / (kSide - 1), 0);
    }
  }
  const auto id = [](int x, int y) { return static_cast<std::uint32_t>(y * kSide + x); };
  for (int y = 0; y + 1 < kSide; ++y) {
    for (int x = 0; x + 1 < kSide; ++x) {
      disc.triangles.push_back({id(x, y), id(x + 1, y), id(x + 1, y + 1)});
      disc.triangles.push_back({id(x, y), id(x + 1, y + 1), id(x, y + 1)});
    }
  }
  for (int i = 0; i + 1 < kSide; ++i) disc.border.push_back(id(i, 0));
  for (int i = 0; i + 1 < kSide; ++i) disc.border.push_back(id(kSide - 1, i));
  for (int i = kSide - 1; i > 0; --i) disc.border.push_back(id(i, kSide - 1));
  for (int i = kSide - 1; i > 0; --i) disc.border.push_back(id(0, i));
  disc.face_of.resize(disc.triangles.size());
  const auto uv = parameterise(disc);
  ASSERT_TRUE(uv.ok());
  for (std::uint32_t v = 0; v < disc.vertex_count(); ++v) {
    EXPECT_NEAR((*uv)[v].x(), disc.positions[v].x(), 1e-12);
    EXPECT_NEAR((*uv)[v].y(), disc.positions[v].y(), 1e-12);
  }
}

TEST(Parameterise, ReweightingLowersTheDistortion) {
  const DiscMesh disc = disc_of(testing::open_cylinder(60, 16, 12));
  const auto worst = [&](int reweightings) {
    const auto uv = parameterise(disc, {.reweightings = reweightings, .good_stretch = 1});
    EXPECT_TRUE(uv.ok());
    std::vector<double> ratios;
    for (std::size_t t = 0; t < disc.face_count(); ++t) ratios.push_back(area_ratio({disc, *uv}, t));
    return *std::max_element(ratios.begin(), ratios.end()) / *std::min_element(ratios.begin(), ratios.end());
  };
  EXPECT_LT(worst(2), worst(0));
}

TEST(Parameterise, EndsWhenItIsCancelled) {
  const DiscMesh disc = disc_of(testing::disc(60, 60));
  std::atomic<bool> cancel = true;
  const ExecutionContext context{.cancel = &cancel};
  for (const ParameterWeights weights : {ParameterWeights::kMeanValue, ParameterWeights::kUniform}) {
    EXPECT_TRUE(absl::IsCancelled(parameterise(disc, {.weights = weights}, context).status()));
  }
  cancel = false;
  std::jthread canceller([&] { cancel = true; });
  const absl::Status status = parameterise(disc, {.reweightings = 1'000, .good_stretch = 1}, context).status();
  EXPECT_TRUE(status.ok() || absl::IsCancelled(status)) << status;
}

}  // namespace
}  // namespace curvecast
