#include "core/remesh/valence_flips.h"

#include <gtest/gtest.h>

#include "core/remesh/angle_flips.h"
#include "core/remesh/insert_points.h"
#include "tests/core/remesh/remesh_cases.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

double surplus(const HalfedgeMesh& mesh) {
  double sum = 0;
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (!mesh.has_vertex(v)) continue;
    double degree = 0;
    mesh.for_each_neighbour(v, [&](std::uint32_t /*w*/) { ++degree; });
    sum += std::pow(degree - (mesh.on_border(v) ? 4 : 6), 2);
  }
  return sum;
}

TEST(ValenceFlips, GiveMoreVerticesSixNeighbours) {
  for (const auto& [name, shape] : remesh_shapes()) {
    SCOPED_TRACE(name);
    HalfedgeMesh mesh(shape, 3'000);
    insert_points(mesh, random_places(shape, 3'000));
    AngleFlips flips(mesh);
    flips.add_all();
    flips.run();
    const double before = surplus(mesh);
    flip_to_valence(mesh);
    EXPECT_LT(surplus(mesh), 0.8 * before);
    expect_same_topology(compacted(mesh), shape);
  }
}

TEST(ValenceFlips, LeaveRegularMeshesAlone) {
  const TriangleMesh shape = make_mesh(torus(30, 20));
  HalfedgeMesh mesh(shape, 0);
  flip_to_valence(mesh);
  EXPECT_EQ(mesh.triangles, shape.triangles);
}

}  // namespace
}  // namespace curvecast
