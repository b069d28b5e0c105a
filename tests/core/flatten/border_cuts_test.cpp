#include "core/flatten/border_cuts.h"

#include <gtest/gtest.h>

#include "core/flatten/flatten.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

struct Lengths {
  double cuts = 0, borders = 0;
};

Lengths lengths_of(const TriangleMesh& mesh, const FlattenOptions& options = {}) {
  FlattenTimes times;
  const absl::StatusOr<std::vector<Chart>> charts = flatten(mesh, options, {}, times);
  EXPECT_TRUE(charts.ok()) << charts.status();
  const DiscMesh& disc = charts->at(0).disc;
  const std::vector<bool> cuts = border_cuts(mesh, disc);
  EXPECT_EQ(cuts.size(), disc.border.size());
  Lengths lengths;
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    const Vec3d &a = disc.positions[disc.border[i]], &b = disc.positions[disc.border[(i + 1) % cuts.size()]];
    (cuts[i] ? lengths.cuts : lengths.borders) += (b - a).norm();
  }
  return lengths;
}

double border_length(const TriangleMesh& mesh) {
  double length = 0;
  for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
    if (mesh.twins[h] == kNone) length += (mesh.positions[mesh.to(h)] - mesh.positions[mesh.from(h)]).norm();
  }
  return length;
}

TEST(BorderCuts, AllOfAClosedSurface) {
  using namespace testing;
  for (const PolygonSoup& soup : {sphere(12, 16), torus(16, 8), perforated_slab(3, 3), tetrahedron(), cube()}) {
    const Lengths lengths = lengths_of(make_mesh(soup));
    EXPECT_GT(lengths.cuts, 0);
    EXPECT_EQ(lengths.borders, 0);
  }
}

TEST(BorderCuts, TheMeshsOwnBorderIsKept) {
  using namespace testing;
  for (const PolygonSoup& soup :
       {disc(6, 20), open_cylinder(8, 12), single_triangle(), filtered(cube(), [](std::size_t p) { return p > 0; })}) {
    const TriangleMesh mesh = make_mesh(soup);
    EXPECT_NEAR(lengths_of(mesh).borders, border_length(mesh), 1e-12);
  }
  EXPECT_EQ(lengths_of(make_mesh(disc(6, 20)), {.extremities = {.most = 0}}).cuts, 0);
  EXPECT_GE(lengths_of(make_mesh(open_cylinder(8, 12))).cuts, 2 * 2 - 1e-12);  // from rim to rim, seen from both sides
}

}  // namespace
}  // namespace curvecast
