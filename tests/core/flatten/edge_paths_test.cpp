#include "core/flatten/edge_paths.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/shapes.h"

namespace curvecast {
namespace {

/// Distances by relaxing every edge until nothing changes.
std::vector<double> slow_distances(const TriangleMesh& mesh, const std::vector<std::uint32_t>& sources) {
  std::vector<double> distance(mesh.vertex_count(), std::numeric_limits<double>::infinity());
  for (const std::uint32_t v : sources) distance[v] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
      const std::uint32_t a = mesh.from(h), b = mesh.to(h);
      const double length = (mesh.positions[a] - mesh.positions[b]).norm();
      if (distance[a] + length < distance[b]) distance[b] = distance[a] + length, changed = true;
      if (distance[b] + length < distance[a]) distance[a] = distance[b] + length, changed = true;
    }
  }
  return distance;
}

TEST(EdgePaths, DistancesAreShortestAndStaySoAsSourcesAreAdded) {
  for (const PolygonSoup& soup : {testing::jittered(testing::disc(8, 20), 0.02), testing::torus(20, 10)}) {
    const TriangleMesh mesh = testing::make_mesh(soup);
    EdgePaths paths(mesh);
    std::vector<std::uint32_t> sources;
    for (const std::uint32_t source : {3u, 77u, 120u}) {
      sources.push_back(source);
      paths.add_sources(std::vector<std::uint32_t>{source});
      const std::vector<double> expected = slow_distances(mesh, sources);
      for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) EXPECT_NEAR(paths.distance(v), expected[v], 1e-12);
    }
  }
}

TEST(EdgePaths, PathsAddUpToTheirDistance) {
  const TriangleMesh mesh = testing::make_mesh(testing::torus(20, 10));
  EdgePaths paths(mesh);
  paths.add_sources(std::vector<std::uint32_t>{0, 50});
  for (std::uint32_t start = 0; start < mesh.vertex_count(); ++start) {
    double length = 0;
    std::uint32_t v = start;
    while (paths.parent_edge(v) != kNone) {
      length += (mesh.positions[v] - mesh.positions[paths.parent(v)]).norm();
      v = paths.parent(v);
    }
    EXPECT_NEAR(length, paths.distance(start), 1e-12);
    EXPECT_TRUE(v == 0 || v == 50);
  }
}

TEST(EdgePaths, PathsOfTargetsAreThoseOfAllAsSourcesAreAdded) {
  const std::vector<std::uint32_t> targets = {150, 30, 9};
  for (const PolygonSoup& soup :
       {testing::jittered(testing::disc(8, 20), 0.02), testing::jittered(testing::torus(20, 10), 0.05)}) {
    const TriangleMesh mesh = testing::make_mesh(soup);
    EdgePaths all(mesh), some(mesh);
    for (const std::uint32_t source : {3u, 77u, 120u, 31u}) {
      all.add_sources({&source, 1});
      some.add_sources({&source, 1}, targets);
      for (std::uint32_t v : targets) {
        EXPECT_NEAR(some.distance(v), all.distance(v), 1e-12);
        EXPECT_EQ(some.source(v), all.source(v));
        for (; all.parent_edge(v) != kNone; v = all.parent(v)) EXPECT_EQ(some.parent_edge(v), all.parent_edge(v));
      }
    }
  }
}

TEST(EdgePaths, PathsOfTargetsLookAtLessOfTheMesh) {
  const TriangleMesh mesh = testing::make_mesh(testing::disc(40, 80));
  EdgePaths paths(mesh);
  const std::uint32_t source = 100, target = 260;  // two rings on
  paths.add_sources({&source, 1}, {&target, 1});
  std::size_t reached = 0;
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) reached += std::isfinite(paths.distance(v));
  EXPECT_LT(reached, mesh.vertex_count() / 10);
}

TEST(EdgePaths, FarthestIsOppositeOnASphere) {
  const TriangleMesh mesh = testing::make_mesh(testing::sphere(20, 30));
  EdgePaths paths(mesh);
  EXPECT_EQ(paths.farthest(), 0u);  // nothing is reached yet
  std::uint32_t north = 0;
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (mesh.positions[v].z() > mesh.positions[north].z()) north = v;
  }
  paths.add_sources(std::vector<std::uint32_t>{north});
  EXPECT_NEAR(mesh.positions[paths.farthest()].z(), -1, 1e-12);
}

}  // namespace
}  // namespace curvecast
