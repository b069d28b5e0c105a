#include "core/flatten/cut_to_disc.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/mesh/topology.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using testing::make_mesh;

double area_of(const DiscMesh& disc) {
  double sum = 0;
  for (const Triangle& t : disc.triangles) {
    sum += 0.5 * (disc.positions[t[1]] - disc.positions[t[0]]).cross(disc.positions[t[2]] - disc.positions[t[0]]).norm();
  }
  return sum;
}

struct Shape {
  const char* name;
  PolygonSoup soup;
};

std::vector<Shape> shapes() {
  using namespace testing;
  return {{"disc", disc(6, 20)},
          {"sphere", sphere(16, 24)},
          {"coarse sphere", sphere(3, 3)},
          {"tetrahedron", tetrahedron()},
          {"cube", cube()},
          {"single triangle", single_triangle()},
          {"torus", torus(24, 12)},
          {"coarse torus", torus(3, 3)},
          {"genus 2", perforated_slab(5, 3)},
          {"genus 9", perforated_slab(7, 7)},
          {"open cylinder", open_cylinder(10, 16)},
          {"short cylinder", open_cylinder(2, 5)},
          {"Moebius strip", mobius_strip(30)}};
}

/// An edge of the disc's triangles: how often it is used in each direction.
using EdgeUse = std::map<std::pair<std::uint32_t, std::uint32_t>, int>;

EdgeUse edge_use(const DiscMesh& disc) {
  EdgeUse use;
  for (const Triangle& t : disc.triangles) {
    for (int i = 0; i < 3; ++i) ++use[{t[i], t[(i + 1) % 3]}];
  }
  return use;
}

TEST(CutToDisc, LeavesATopologicalDiscWhateverTheShape) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const TriangleMesh mesh = make_mesh(shape.soup);
    const absl::StatusOr<DiscMesh> disc = cut_to_disc(mesh);
    ASSERT_TRUE(disc.ok()) << disc.status().message();
    const EdgeUse use = edge_use(*disc);
    std::size_t border = 0;
    std::size_t halves = 0;
    for (const auto& [edge, count] : use) {
      EXPECT_EQ(count, 1);
      const bool inner = use.contains({edge.second, edge.first});
      border += !inner;
      halves += inner;
    }
    EXPECT_EQ(border, disc->border.size());
    const auto euler = static_cast<long>(disc->vertex_count()) - static_cast<long>(border + halves / 2) +
                       static_cast<long>(disc->triangles.size());
    EXPECT_EQ(euler, 1);
    // The border is one loop through distinct vertices, with the surface on its left.
    EXPECT_EQ(std::set<std::uint32_t>(disc->border.begin(), disc->border.end()).size(), disc->border.size());
    EXPECT_GE(disc->border.size(), 4u);
    for (std::size_t i = 0; i < disc->border.size(); ++i) {
      EXPECT_TRUE(use.contains({disc->border[i], disc->border[(i + 1) % disc->border.size()]}));
    }
  }
}

TEST(CutToDisc, KeepsTheSurface) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const TriangleMesh mesh = make_mesh(shape.soup);
    const absl::StatusOr<DiscMesh> disc = cut_to_disc(mesh);
    ASSERT_TRUE(disc.ok());
    EXPECT_NEAR(area_of(*disc), surface_area(mesh), 1e-12 * surface_area(mesh));
    std::vector<double> covered(mesh.face_count(), 0.0);
    for (std::size_t t = 0; t < disc->triangles.size(); ++t) {
      const Triangle& v = disc->triangles[t];
      const Vec3d cross = (disc->positions[v[1]] - disc->positions[v[0]]).cross(disc->positions[v[2]] - disc->positions[v[0]]);
      covered[disc->face_of[t]] += 0.5 * cross.norm();
      const Triangle& m = mesh.triangles[disc->face_of[t]];
      const Vec3d whole = (mesh.positions[m[1]] - mesh.positions[m[0]]).cross(mesh.positions[m[2]] - mesh.positions[m[0]]);
      EXPECT_GT(cross.dot(whole), 0) << "triangle " << t << " is turned";
    }
    for (std::size_t f = 0; f < covered.size(); ++f) EXPECT_NEAR(covered[f], triangle_area(mesh, f), 1e-12);
  }
}

TEST(CutToDisc, NoInnerEdgeJoinsTwoBorderVertices) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const TriangleMesh mesh = make_mesh(shape.soup);
    const absl::StatusOr<DiscMesh> disc = cut_to_disc(mesh);
    ASSERT_TRUE(disc.ok());
    const std::set<std::uint32_t> border(disc->border.begin(), disc->border.end());
    const EdgeUse use = edge_use(*disc);
    for (const auto& [edge, count] : use) {
      if (use.contains({edge.second, edge.first})) {
        EXPECT_FALSE(border.contains(edge.first) && border.contains(edge.second));
      }
    }
  }
}

TEST(CutToDisc, CutsASphereShort) {
  const TriangleMesh mesh = make_mesh(testing::sphere(40, 60));
  const absl::StatusOr<DiscMesh> disc = cut_to_disc(mesh);
  ASSERT_TRUE(disc.ok());
  double length = 0;
  for (std::size_t i = 0; i < disc->border.size(); ++i) {
    length += (disc->positions[disc->border[i]] - disc->positions[disc->border[(i + 1) % disc->border.size()]]).norm();
  }
  EXPECT_LT(length / 2, 4.2);  // a half circle has 3.14, along edges a little more
}

TEST(CutToDisc, CutsToEveryExtremity) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const TriangleMesh mesh = make_mesh(shape.soup);
    const std::vector<std::uint32_t> tips = {0, static_cast<std::uint32_t>(mesh.vertex_count() / 2), 2};
    const absl::StatusOr<DiscMesh> disc = cut_to_disc(mesh, tips);
    ASSERT_TRUE(disc.ok());
    for (const std::uint32_t tip : tips) {
      const bool there = std::any_of(disc->border.begin(), disc->border.end(),
                                     [&](std::uint32_t v) { return disc->positions[v] == mesh.positions[tip]; });
      EXPECT_TRUE(there) << "no border at vertex " << tip;
    }
  }
}

TEST(CutToDisc, OpensASphereBetweenTheFirstTwoExtremities) {
  const TriangleMesh mesh = make_mesh(testing::sphere(16, 24));
  const std::vector<std::uint32_t> ends = {100, 101};
  const absl::StatusOr<DiscMesh> disc = cut_to_disc(mesh, ends);
  ASSERT_TRUE(disc.ok());
  EXPECT_EQ(disc->border.size(), 4u);  // both sides of the one edge between them, halved
}

TEST(CutToDisc, RefusesPiecesApart) {
  const TriangleMesh mesh = make_mesh(testing::merged(testing::tetrahedron(), testing::translated(testing::cube(), {5, 0, 0})));
  EXPECT_EQ(cut_to_disc(mesh).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(cut_to_disc({}).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace curvecast
