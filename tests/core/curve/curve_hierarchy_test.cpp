#include "core/curve/curve_hierarchy.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "core/base/random.h"
#include "core/pipeline/pipeline.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Everything that the header promises.
void expect_sound(const SurfaceCurve& curve, const CurveHierarchy& hierarchy) {
  const auto& nodes = hierarchy.nodes;
  const std::size_t kinds = curve.scalars.size();
  ASSERT_FALSE(nodes.empty());
  ASSERT_EQ(hierarchy.scalars.size(), nodes.size() * kinds);
  EXPECT_EQ(nodes[0].first, 0u);
  EXPECT_EQ(nodes[0].last, curve.size());
  EXPECT_EQ(nodes[0].skip, nodes.size());
  std::size_t disc = 0;
  for (std::size_t i = 1; i < nodes.size(); i = nodes[i].skip, ++disc) {
    while (curve.disc_begin[disc] == curve.disc_begin[disc + 1]) ++disc;
    EXPECT_EQ(nodes[i].first, curve.disc_begin[disc]);
    EXPECT_EQ(nodes[i].last, curve.disc_begin[disc + 1]);
  }
  EXPECT_EQ(disc + 1, curve.disc_begin.size());
  std::uint32_t leaf_end = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const CurveNode& node = nodes[i];
    ASSERT_LT(node.first, node.last);
    ASSERT_GT(node.skip, i);
    double area = 0, child_area = 0;
    for (std::uint32_t l = node.first; l < node.last; ++l) {
      ASSERT_LE((curve.position(l).cast<double>() - node.sphere_center().cast<double>()).norm(), node.radius) << "node " << i;
      const Vec3d normal = curve.normal(l).cast<double>(), axis = node.cone_axis().cast<double>();
      const double cosine = normal.dot(axis) / (normal.norm() * axis.norm());
      ASSERT_TRUE(!node.has_cone() || cosine >= node.cosine) << "node " << i;
      area += static_cast<double>(curve.area[l]);
      for (int kind = 0; kind < kCurvatureKinds; ++kind) {
        const float k = curvature_measure(static_cast<CurvatureKind>(kind), curve.curvature_min[l], curve.curvature_max[l]);
        ASSERT_LE(node.curvature[kind].min, k);
        ASSERT_GE(node.curvature[kind].max, k);
      }
      for (std::size_t s = 0; s < kinds; ++s) {
        const float value = curve.scalars[s].values[l];
        const ValueBounds& bounds = hierarchy.scalars[i * kinds + s];
        ASSERT_TRUE(std::isnan(value) || (bounds.min <= value && value <= bounds.max));
      }
    }
    EXPECT_NEAR(node.area, area, 1e-6 * area);
    if (hierarchy.is_leaf(i)) {
      EXPECT_EQ(node.first, leaf_end) << "every vertex lies in exactly one leaf";
      EXPECT_LE(node.size(), CurveHierarchy::kMaxLeafVertices);
      leaf_end = node.last;
      continue;
    }
    std::uint32_t child_end = node.first;
    for (std::size_t child = i + 1; child < node.skip; child = nodes[child].skip) {
      EXPECT_EQ(nodes[child].first, child_end);
      child_end = nodes[child].last;
      child_area += static_cast<double>(nodes[child].area);
    }
    EXPECT_EQ(child_end, node.last);
    EXPECT_NEAR(node.area, child_area, 1e-6 * child_area);
  }
  EXPECT_EQ(leaf_end, curve.size());
}

void expect_same_bytes(const CurveHierarchy& a, const CurveHierarchy& b) {
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  ASSERT_EQ(a.scalars.size(), b.scalars.size());
  EXPECT_EQ(std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(CurveNode)), 0);
  EXPECT_EQ(std::memcmp(a.scalars.data(), b.scalars.data(), a.scalars.size() * sizeof(ValueBounds)), 0);
}

/// Appends the leaves of a quadtree that is deeper here than there.
void grow(std::uint64_t index, int level, int most, std::uint64_t& counter, std::vector<std::pair<std::uint64_t, int>>& leaves) {
  const double u = random_unit(9, counter++);
  if (level == most || (level > 2 && u < 0.25)) {
    if (u > 0.05) leaves.emplace_back(index << 2 * (30 - level), level);  // some quads hold nothing
    return;
  }
  for (unsigned i = 0; i < 4; ++i) grow(index << 2 | i, level + 1, most, counter, leaves);
}

/// Random values on random adaptive trees, one for each disc; discs of depth 0 have one vertex.
SurfaceCurve random_curve(std::initializer_list<int> depths) {
  std::vector<std::pair<std::uint64_t, int>> leaves;
  SurfaceCurve curve;
  curve.disc_begin = {0};
  std::uint64_t counter = 0;
  for (const int depth : depths) {
    grow(0, 0, depth, counter, leaves);
    if (depth == 0) leaves.resize(curve.disc_begin.back() + 1, {0, 0});
    curve.disc_begin.push_back(static_cast<std::uint32_t>(leaves.size()));
  }
  curve.scalars = {{"a", {}}, {"b", {}}};
  curve.resize(leaves.size());
  for (std::size_t l = 0; l < leaves.size(); ++l) {
    const auto u = [&](int i) { return static_cast<float>(random_unit(4, 16 * l + static_cast<std::uint64_t>(i))); };
    curve.x[l] = u(0), curve.y[l] = 3 * u(1) - 7, curve.z[l] = u(2) * static_cast<float>(l);
    const Vec3f wide = Vec3f(u(3), u(4), u(5)) - Vec3f::Constant(0.5f);
    const Vec3f normal = (l % 1000 < 500 ? Vec3f(Vec3f::UnitX() + 0.3f * wide) : wide).normalized();
    curve.nx[l] = normal.x(), curve.ny[l] = normal.y(), curve.nz[l] = normal.z();
    curve.curvature_min[l] = -9 * u(6), curve.curvature_max[l] = 4 * u(7);
    curve.area[l] = u(8);
    curve.scalars[0].values[l] = l % 3 == 0 ? kNan : u(9);
    curve.scalars[1].values[l] = kNan;
    curve.key[l] = leaves[l].first, curve.level[l] = static_cast<std::uint8_t>(leaves[l].second);
  }
  return curve;
}

TEST(CurveHierarchy, HoldsWhatLiesBelowOnRandomTrees) {
  for (const auto& depths : {std::initializer_list<int>{7}, {8, 0, 4, 6}, {0, 0, 0}, {3}}) {
    const SurfaceCurve curve = random_curve(depths);
    const CurveHierarchy hierarchy = build_hierarchy(curve);
    expect_sound(curve, hierarchy);
    for (std::size_t i = 0; i < hierarchy.nodes.size(); ++i) {
      EXPECT_GT(hierarchy.scalars[2 * i + 1].min, hierarchy.scalars[2 * i + 1].max) << "there is nothing but NaN";
    }
  }
}

TEST(CurveHierarchy, HoldsWhatLiesBelowOnShapes) {
  using namespace testing;
  for (const PolygonSoup& soup :
       {icosphere(3), torus(24, 12), cube(), merged(disc(6, 20), translated(single_triangle(), {5, 0, 0}))}) {
    const absl::StatusOr<Preprocessed> result = preprocess({"shape.off", to_off(soup)}, {.points = 1000});
    ASSERT_TRUE(result.ok());
    expect_sound(*result->curve, result->curve->hierarchy);
    EXPECT_NEAR(result->curve->hierarchy.nodes[0].area, result->curve->total_area, 1e-6 * result->curve->total_area);
  }
}

TEST(CurveHierarchy, OfARealMeshIsSmall) {
  const std::filesystem::path path = std::filesystem::path(CURVECAST_SOURCE_DIR) / "../shared/meshes/camelhead.off";
  std::ifstream file(path, std::ios::binary);
  if (!file) GTEST_SKIP() << path << " is not there";
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  const absl::StatusOr<Preprocessed> result = preprocess({"camelhead.off", bytes}, {.points = 10'000});
  ASSERT_TRUE(result.ok()) << result.status();
  const SurfaceCurve& curve = *result->curve;
  expect_sound(curve, curve.hierarchy);
  EXPECT_LT(static_cast<double>(curve.hierarchy.byte_size()), 0.05 * static_cast<double>(curve.byte_size()));
}

TEST(CurveHierarchy, SpheresAndConesAreNotMuchTooLarge) {
  const absl::StatusOr<Preprocessed> result = preprocess({"ball.off", testing::to_off(testing::icosphere(4))}, {.points = 5000});
  ASSERT_TRUE(result.ok());
  const CurveHierarchy& hierarchy = result->curve->hierarchy;
  for (std::size_t i = 0; i < hierarchy.nodes.size(); ++i) {
    const CurveNode& node = hierarchy.nodes[i];
    EXPECT_LE(node.radius, 1.75f);
    if (!hierarchy.is_leaf(i)) continue;
    EXPECT_LT(node.radius, 4 * std::sqrt(node.area));
    EXPECT_LT(node.cone_sine(), 5 * std::sqrt(node.area)) << "on a ball of radius 1";
    EXPECT_TRUE(node.has_cone());
  }
}

TEST(CurveHierarchy, IsTheSameForAnyNumberOfThreads) {
  const SurfaceCurve curve = random_curve({9, 6, 0});
  CurveHierarchy one, many;
  tbb::task_arena(1).execute([&] { one = build_hierarchy(curve); });
  tbb::task_arena(4).execute([&] { many = build_hierarchy(curve); });
  expect_same_bytes(one, many);
}

TEST(CurveHierarchy, OfNothingIsEmpty) {
  EXPECT_TRUE(build_hierarchy({}).nodes.empty());
  SurfaceCurve curve;
  curve.disc_begin = {0};
  EXPECT_TRUE(build_hierarchy(curve).nodes.empty());
}

}  // namespace
}  // namespace curvecast
