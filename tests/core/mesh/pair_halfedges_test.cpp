#include "core/mesh/pair_halfedges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "core/base/random.h"
#include "core/mesh/triangle_mesh.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

/// Each edge's halfedges, ascending, found one by one.
std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> edges_of(const std::vector<Triangle>& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> edges;
  for (std::uint32_t h = 0; h < 3 * triangles.size(); ++h) {
    const auto [smaller, larger] = std::minmax(triangles[h / 3][h % 3], triangles[h / 3][(h + 1) % 3]);
    edges[{smaller, larger}].push_back(h);
  }
  return edges;
}

void expect_pairs(const std::vector<Triangle>& triangles, std::size_t vertex_count) {
  const HalfedgePairs pairs = pair_halfedges(triangles, vertex_count);
  std::vector<std::uint32_t> twins(3 * triangles.size(), kNone), border;
  std::uint64_t nonmanifold = 0;
  for (const auto& [ends, halfedges] : edges_of(triangles)) {
    if (halfedges.size() == 1) border.push_back(halfedges[0]);
    if (halfedges.size() == 2) twins[halfedges[0]] = halfedges[1], twins[halfedges[1]] = halfedges[0];
    nonmanifold += halfedges.size() > 2 ? 1 : 0;
  }
  std::sort(border.begin(), border.end());
  EXPECT_EQ(pairs.twins, twins);
  EXPECT_EQ(pairs.border, border);
  EXPECT_EQ(pairs.nonmanifold_edges, nonmanifold);
  bool is_oriented = true;
  for (std::uint32_t h = 0; h < twins.size(); ++h) {
    if (twins[h] != kNone) is_oriented &= triangles[h / 3][h % 3] != triangles[twins[h] / 3][twins[h] % 3];
  }
  EXPECT_EQ(pairs.is_oriented, is_oriented);
}

TEST(PairHalfedges, OfShapes) {
  for (const PolygonSoup& soup : {single_triangle(), disc(40, 90), icosphere(5), torus(80, 70), perforated_slab(9, 5)}) {
    const TriangleMesh mesh = make_mesh(soup);
    expect_pairs(mesh.triangles, mesh.vertex_count());
  }
}

TEST(PairHalfedges, OfAnyTriangles) {
  // From hardly any common edge to many of each.
  for (const std::uint64_t vertices : {4u, 5u, 30u, 1'000u, 200'000u}) {
    std::vector<Triangle> triangles;
    for (std::uint64_t i = 0; triangles.size() < 40'000; ++i) {
      const auto corner = [&](std::uint64_t k) { return static_cast<std::uint32_t>(mix_bits(3 * i + k) % vertices); };
      const Triangle t = {corner(0), corner(1), corner(2)};
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
    }
    expect_pairs(triangles, vertices);
  }
}

TEST(PairHalfedges, OneVertexInAllFaces) {
  std::vector<Triangle> fan;
  constexpr std::uint32_t kFaces = 300'000;
  for (std::uint32_t f = 0; f < kFaces; ++f) fan.push_back({0, 1 + f, 1 + (f + 1) % kFaces});
  const HalfedgePairs pairs = pair_halfedges(fan, kFaces + 1);
  EXPECT_EQ(pairs.border.size(), kFaces);
  EXPECT_EQ(pairs.nonmanifold_edges, 0u);
  EXPECT_FALSE(pairs.may_have_duplicates);
  for (std::uint32_t f = 0; f < kFaces; ++f) ASSERT_EQ(pairs.twins[3 * f + 2], 3 * ((f + 1) % kFaces));
}

TEST(PairHalfedges, NoticesDuplicates) {
  FaceList faces{{{0, 1, 2}, {2, 1, 3}, {1, 2, 0}, {3, 2, 1}, {2, 0, 4}}, {}, {}};
  EXPECT_TRUE(pair_halfedges(faces.triangles, 5).may_have_duplicates);
  EXPECT_EQ(drop_duplicates(faces), 2u);
  EXPECT_EQ(faces.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}, {2, 0, 4}}));
  EXPECT_FALSE(pair_halfedges(faces.triangles, 5).may_have_duplicates);
  // A face alone with its copy has two faces at every edge.
  EXPECT_TRUE(pair_halfedges({{0, 1, 2}, {0, 2, 1}}, 3).may_have_duplicates);
}

}  // namespace
}  // namespace curvecast
