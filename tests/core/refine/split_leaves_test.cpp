#include "core/refine/split_leaves.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstring>
#include <string>
#include <string_view>

#include "core/base/random.h"
#include "tests/core/refine/refined.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

/// 0 to 3 levels, most of them 0.
std::vector<std::uint8_t> some_levels(const SurfaceCurve& curve) {
  std::vector<std::uint8_t> levels(curve.size());
  for (std::size_t l = 0; l < levels.size(); ++l) {
    const double r = random_unit(5, l);
    levels[l] = r < 0.8 ? 0 : r < 0.9 ? 1 : r < 0.97 ? 2 : 3;
  }
  return levels;
}

SurfaceCurve split(const Refinable& shape, const std::vector<std::uint8_t>& levels) {
  absl::StatusOr<SurfaceCurve> out = split_leaves(*shape.base, shape.curve(), levels);
  EXPECT_TRUE(out.ok()) << out.status();
  return *std::move(out);
}

TEST(SplitLeaves, DividesThoseAskedForAndNoOthers) {
  for (const auto& shape : refinable_shapes()) {
    const SurfaceCurve& curve = shape->curve();
    const std::vector<std::uint8_t> levels = some_levels(curve);
    const SurfaceCurve finer = split(*shape, levels);
    EXPECT_EQ(finer.revision, curve.revision + 1);
    expect_valid_curve(finer);
    std::size_t m = 0;
    for (std::size_t l = 0; l < curve.size(); ++l) {
      if (levels[l] == 0) {
        ASSERT_TRUE(same_vertex(curve, l, finer, m));
        ASSERT_EQ(curve.area[l], finer.area[m]);
        ++m;
        continue;
      }
      double sum = 0;
      for (int i = 0; i < 1 << 2 * levels[l]; ++i, ++m) {
        ASSERT_EQ(finer.level[m], curve.level[l] + levels[l]);
        ASSERT_GE(finer.area[m], 0);
        sum += static_cast<double>(finer.area[m]);
      }
      ASSERT_NEAR(sum, static_cast<double>(curve.area[l]), 1e-6 * static_cast<double>(curve.area[l]));
    }
    EXPECT_EQ(m, finer.size());
  }
}

TEST(SplitLeaves, MakesTheLeavesOfAFirstBuild) {
  for (const auto& shape : refinable_shapes()) {
    const SurfaceCurve& curve = shape->curve();
    const SurfaceCurve finer = split(*shape, std::vector<std::uint8_t>(curve.size(), 2));
    const absl::StatusOr<Preprocessed> fresh = lay_curve(shape->done.flattened, {.points = 16 * curve.max_points});
    ASSERT_TRUE(fresh.ok());
    const SurfaceCurve& first = *fresh->curve;
    const double mean = curve.total_area / static_cast<double>(first.size());
    const std::size_t common = for_each_common(finer, first, [&](std::size_t l, std::size_t m) {
      ASSERT_TRUE(same_vertex(finer, l, first, m));
      ASSERT_NEAR(finer.area[l], first.area[m], 2e-6 * first.area[m] + 1e-9 * mean);
    });
    // All but children that lie away from the triangle for which their parent was divided.
    EXPECT_GT(static_cast<double>(common), 0.95 * static_cast<double>(first.size()));
  }
}

/// A tetrahedron with colours and a scalar.
std::unique_ptr<Refinable> coloured_shape() {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float quality\n"
      "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 255 0 0 1\n1 0 0 0 255 0 2\n0 1 0 0 0 255 5\n0 0 1 255 255 255 -3\n"
      "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
  return refinable({"a.ply", ply}, {.points = 300});
}

TEST(SplitLeaves, CarriesColoursAndScalars) {
  const auto shape = coloured_shape();
  const SurfaceCurve& curve = shape->curve();
  const SurfaceCurve finer = split(*shape, std::vector<std::uint8_t>(curve.size(), 1));
  const absl::StatusOr<Preprocessed> fresh = lay_curve(shape->done.flattened, {.points = 4 * curve.max_points});
  ASSERT_TRUE(fresh.ok());
  ASSERT_EQ(finer.colour.size(), finer.size());
  ASSERT_EQ(finer.scalars.size(), 1u);
  EXPECT_EQ(finer.scalars[0].name, "quality");
  const std::size_t common = for_each_common(
      finer, *fresh->curve, [&](std::size_t l, std::size_t m) { ASSERT_TRUE(same_vertex(finer, l, *fresh->curve, m)); });
  EXPECT_GT(static_cast<double>(common), 0.95 * static_cast<double>(finer.size()));
}

template <typename T>
std::string bytes_of_entry(const Column<T>& column, std::size_t l) {
  return {reinterpret_cast<const char*>(&column[l]), sizeof(T)};
}

TEST(SplitLeaves, CarriesEveryColumnThatThereIs) {
  const auto shape = coloured_shape();
  SurfaceCurve curve = shape->curve();
  // Any bytes that differ from leaf to leaf will do, but where the columns say which leaf it is.
  std::uint64_t seed = 0;
  visit_columns(curve, [&]<typename T>(std::string_view name, Column<T>& column, ColumnLength /*length*/) {
    if (name == "key" || name == "level" || name == "triangle") return;
    ASSERT_EQ(column.size(), curve.size()) << name;
    ++seed;
    for (std::size_t l = 0; l < column.size(); ++l) {
      const auto bits = static_cast<std::uint64_t>(random_unit(seed, l) * 0x1p53) << 3;
      std::memcpy(static_cast<void*>(&column[l]), &bits, sizeof(T));
    }
  });
  for (ScalarColumn& scalar : curve.scalars) {
    for (std::size_t l = 0; l < curve.size(); ++l) scalar.values[l] = static_cast<float>(random_unit(++seed, l));
  }
  const std::vector<std::uint8_t> levels = some_levels(curve);
  absl::StatusOr<SurfaceCurve> finer = split_leaves(*shape->base, curve, levels);
  ASSERT_TRUE(finer.ok()) << finer.status();
  visit_column_members([&](const char* name, auto column, ColumnLength /*length*/) {
    ASSERT_EQ((*finer.*column).size(), finer->size()) << name;
    for (std::size_t l = 0, m = 0; l < curve.size(); m += std::size_t{1} << 2 * levels[l], ++l) {
      if (levels[l] > 0) continue;
      ASSERT_EQ(bytes_of_entry(curve.*column, l), bytes_of_entry(*finer.*column, m)) << name;
    }
  });
  for (std::size_t s = 0; s < curve.scalars.size(); ++s) {
    for (std::size_t l = 0, m = 0; l < curve.size(); m += std::size_t{1} << 2 * levels[l], ++l) {
      if (levels[l] > 0) continue;
      ASSERT_EQ(curve.scalars[s].values[l], finer->scalars[s].values[m]);
    }
  }
}

TEST(SplitLeaves, IsTheSameForAnyNumberOfThreads) {
  const auto shape = refinable(torus(60, 30), 3000);
  const std::vector<std::uint8_t> levels = some_levels(shape->curve());
  tbb::task_arena one(1), four(4);
  const SurfaceCurve a = one.execute([&] { return split(*shape, levels); });
  const SurfaceCurve b = four.execute([&] { return split(*shape, levels); });
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t l = 0; l < a.size(); ++l) {
    ASSERT_TRUE(same_vertex(a, l, b, l));
    ASSERT_EQ(a.area[l], b.area[l]);
  }
}

TEST(SplitLeaves, GoesToTheLastLevel) {
  const auto shape = refinable(icosphere(2), 1);
  const SurfaceCurve& curve = shape->curve();
  // One leaf at a time: a whole subtree would be too many.
  SurfaceCurve now = curve;
  while (now.level[0] < kMaxLevel) {
    std::vector<std::uint8_t> levels(now.size(), 0);
    levels[0] = static_cast<std::uint8_t>(std::min(3, kMaxLevel - now.level[0]));
    absl::StatusOr<SurfaceCurve> next = split_leaves(*shape->base, now, levels);
    ASSERT_TRUE(next.ok());
    now = *std::move(next);
  }
  expect_valid_curve(now);
}

TEST(SplitLeaves, StopsWhenCancelled) {
  const auto shape = refinable(icosphere(3));
  const std::atomic<bool> cancel = true;
  const std::vector<std::uint8_t> levels(shape->curve().size(), 1);
  EXPECT_EQ(split_leaves(*shape->base, shape->curve(), levels, {.cancel = &cancel}).status().code(),
            absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace curvecast
