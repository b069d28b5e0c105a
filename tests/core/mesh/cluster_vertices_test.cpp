#include "core/mesh/cluster_vertices.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/mesh/repair.h"
#include "core/mesh/topology.h"

namespace curvecast {
namespace {

/// A ball of n x 2n quads that share no vertices, coloured by height, with a scalar.
PolygonSoup ball(std::uint32_t n) {
  PolygonSoup soup;
  soup.attributes.scalars.push_back({"height", {}});
  const auto vertex = [&](std::uint32_t i, std::uint32_t j) {
    const double theta = M_PI * i / n, phi = M_PI * (j % (2 * n)) / n;
    const Vec3d p(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
    soup.positions.push_back(p);
    soup.attributes.colours.push_back({unit_to_byte(0.5 + 0.5 * p.z()), 10, 20, 255});
    soup.attributes.scalars[0].values.push_back(static_cast<float>(p.z()));
    soup.indices.push_back(static_cast<std::uint32_t>(soup.positions.size() - 1));
  };
  soup.polygon_begin.push_back(0);
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < 2 * n; ++j) {
      vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1);
      soup.polygon_begin.push_back(static_cast<std::uint32_t>(soup.indices.size()));
    }
  }
  return soup;
}

TEST(ClusterVertices, KeepsTheShapeOfAGreatSurface) {
  const PolygonSoup coarse = cluster_vertices(ball(300), 4000);
  EXPECT_GT(coarse.positions.size(), 2000u);
  EXPECT_LT(coarse.positions.size(), 8000u);
  const absl::StatusOr<RepairedMesh> repaired = repair(coarse);
  ASSERT_TRUE(repaired.ok()) << repaired.status();
  EXPECT_NEAR(surface_area(repaired->mesh), 4 * M_PI, 0.02 * 4 * M_PI);
  for (std::size_t v = 0; v < repaired->mesh.vertex_count(); ++v) {
    const Vec3d& p = repaired->mesh.positions[v];
    EXPECT_NEAR(p.norm(), 1, 0.01);
    EXPECT_NEAR(repaired->attributes.colours[v].r, 255 * (0.5 + 0.5 * p.z()), 2);
    EXPECT_EQ(repaired->attributes.colours[v].g, 10);
    EXPECT_NEAR(repaired->attributes.scalars[0].values[v], p.z(), 1e-6);
  }
}

TEST(ClusterVertices, KeepsEachTriangleOnce) {
  const PolygonSoup coarse = cluster_vertices(ball(200), 1000);
  std::set<std::array<std::uint32_t, 3>> seen;
  for (std::size_t p = 0; p < coarse.polygon_count(); ++p) {
    ASSERT_EQ(coarse.polygon_begin[p + 1] - coarse.polygon_begin[p], 3u);
    std::array<std::uint32_t, 3> corners = {};
    std::copy_n(coarse.indices.begin() + coarse.polygon_begin[p], 3, corners.begin());
    EXPECT_TRUE(corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0]);
    EXPECT_TRUE(seen.insert(corners).second);
  }
}

TEST(ClusterVertices, GivesTheSameForAnyNumberOfThreads) {
  const PolygonSoup soup = ball(150);
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return cluster_vertices(soup, 2000);
  };
  const PolygonSoup one = with_threads(1), four = with_threads(4);
  EXPECT_EQ(one.positions, four.positions);
  EXPECT_EQ(one.indices, four.indices);
  EXPECT_EQ(one.attributes.colours, four.attributes.colours);
}

TEST(ClusterVertices, TakesCornersAndFacesFromTheSoup) {
  PolygonSoup soup = ball(60);
  MeshAttributes& attributes = soup.attributes;
  for (const std::uint32_t v : soup.indices) {
    attributes.uv.emplace_back(static_cast<float>(soup.positions[v].x()), static_cast<float>(soup.positions[v].y()));
  }
  attributes.materials = {{"south", {}, nullptr}, {"north", {}, nullptr}};
  for (std::size_t p = 0; p < soup.polygon_count(); ++p) {
    attributes.material_of_face.push_back(soup.positions[soup.indices[soup.polygon_begin[p]]].z() > 0 ? 1 : 0);
  }
  const PolygonSoup coarse = cluster_vertices(soup, 1500);
  ASSERT_EQ(coarse.attributes.uv.size(), coarse.indices.size());
  ASSERT_EQ(coarse.attributes.material_of_face.size(), coarse.polygon_count());
  for (std::size_t c = 0; c < coarse.indices.size(); ++c) {
    const Vec3d& p = coarse.positions[coarse.indices[c]];
    EXPECT_NEAR(coarse.attributes.uv[c].x(), p.x(), 0.15);
    EXPECT_NEAR(coarse.attributes.uv[c].y(), p.y(), 0.15);
    if (std::abs(p.z()) < 0.3) continue;
    EXPECT_EQ(coarse.attributes.material_of_face[c / 3], p.z() > 0 ? 1u : 0u);
  }
}

TEST(ClusterVertices, SurvivesWhatHasNoSize) {
  EXPECT_EQ(cluster_vertices(PolygonSoup(), 100).polygon_count(), 0u);
  PolygonSoup point;
  point.positions.assign(3, Vec3d(1, 2, 3));
  point.polygon_begin = {0, 3};
  point.indices = {0, 1, 2};
  EXPECT_EQ(cluster_vertices(point, 100).polygon_count(), 0u);
  PolygonSoup far = ball(20);  // the grid must not grow with the farthest vertex
  far.positions.emplace_back(1e300, 0, 0);
  for (ScalarAttribute& scalar : far.attributes.scalars) scalar.values.push_back(0);
  far.attributes.colours.emplace_back();
  EXPECT_LE(cluster_vertices(far, 100).positions.size(), far.positions.size());
}

}  // namespace
}  // namespace curvecast
