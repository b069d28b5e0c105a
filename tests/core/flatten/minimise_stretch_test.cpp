#include "core/flatten/minimise_stretch.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <set>

#include "core/flatten/cut_to_disc.h"
#include "core/flatten/distortion.h"
#include "core/flatten/parameterise.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

std::vector<DiscMesh> discs() {
  using namespace testing;
  std::vector<DiscMesh> all;
  for (const PolygonSoup& soup :
       {disc(8, 24), jittered(sphere(20, 30), 0.02), torus(24, 12), perforated_slab(5, 5), perforated_slab(17, 17),
        open_cylinder(12, 16), open_cylinder(60, 16, 12), single_triangle(), tetrahedron(), cube(), icosphere(4)}) {
    all.push_back(*cut_to_disc(make_mesh(soup)));
  }
  return all;
}

TEST(MinimiseStretch, CoversTheSquareOnceWithoutAFlip) {
  for (const DiscMesh& disc : discs()) {
    const auto uv = minimise_stretch(disc);
    ASSERT_TRUE(uv.ok()) << uv.status().message();
    EXPECT_EQ(count_flipped(disc, *uv), 0u);
    double area = 0;
    for (std::size_t t = 0; t < disc.face_count(); ++t) area += uv_area({disc, *uv}, t);
    EXPECT_NEAR(area, 1, 1e-12);
    std::set<std::pair<double, double>> corners;
    double length = 0;
    for (std::size_t i = 0; i < disc.border.size(); ++i) {
      const Vec2d &p = (*uv)[disc.border[i]], &q = (*uv)[disc.border[(i + 1) % disc.border.size()]];
      EXPECT_TRUE(p.x() == 0 || p.x() == 1 || p.y() == 0 || p.y() == 1);
      if ((p.x() == 0 || p.x() == 1) && (p.y() == 0 || p.y() == 1)) corners.insert({p.x(), p.y()});
      length += (p - q).norm();
    }
    EXPECT_EQ(corners.size(), 4u);
    EXPECT_NEAR(length, 4, 1e-9);
  }
}

TEST(MinimiseStretch, StretchesLessThanMeanValueCoordinates) {
  for (const DiscMesh& disc : discs()) {
    if (disc.vertex_count() < 20) continue;
    const auto uv = minimise_stretch(disc);
    const auto mean_value = parameterise(disc);
    ASSERT_TRUE(uv.ok() && mean_value.ok());
    EXPECT_LT(measure_stretch(disc, *uv).total, 1.02 * measure_stretch(disc, *mean_value).total);
  }
}

TEST(MinimiseStretch, AFlatSquareStaysAsItIs) {
  // A plate of n x n cells is its own map.
  constexpr std::uint32_t kCells = 24;
  std::vector<Vec3d> positions;
  std::vector<std::vector<std::uint32_t>> quads;
  for (std::uint32_t j = 0; j <= kCells; ++j) {
    for (std::uint32_t i = 0; i <= kCells; ++i) positions.emplace_back(i, j, 0);
  }
  for (std::uint32_t j = 0; j < kCells; ++j) {
    for (std::uint32_t i = 0; i < kCells; ++i) {
      const std::uint32_t v = j * (kCells + 1) + i;
      quads.push_back({v, v + 1, v + kCells + 2, v + kCells + 1});
    }
  }
  const DiscMesh disc = *cut_to_disc(testing::make_mesh(testing::soup_of(positions, quads)));
  const auto uv = minimise_stretch(disc);
  ASSERT_TRUE(uv.ok());
  // The border starts at any of its vertices, so the square may lie turned; a turned plate costs a little.
  EXPECT_LT(measure_stretch(disc, *uv).total, 1.25);
}

TEST(MinimiseStretch, TheSameOnAnyNumberOfThreads) {
  const DiscMesh disc = *cut_to_disc(testing::make_mesh(testing::jittered(testing::torus(120, 60), 0.005)));
  std::vector<std::vector<Vec2d>> results;
  for (const int threads : {1, 2, 4}) {
    tbb::task_arena arena(threads);
    results.push_back(*arena.execute([&] { return minimise_stretch(disc); }));
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST(MinimiseStretch, StopsWhenCancelled) {
  const std::atomic<bool> cancel = true;
  const DiscMesh disc = *cut_to_disc(testing::make_mesh(testing::torus(60, 30)));
  EXPECT_EQ(minimise_stretch(disc, {}, {.cancel = &cancel}).status().code(), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace curvecast
