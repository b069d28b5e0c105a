#include "client/bench/subdivide.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/mesh/topology.h"
#include "tests/support/shapes.h"

namespace curvecast::cli::bench {
namespace {

TEST(Subdivide, KeepsTheTopologyAndMatchesTwins) {
  using namespace curvecast::testing;
  for (const PolygonSoup& soup : {torus(12, 8), open_cylinder(6, 8), disc(4, 9), mobius_strip(12), tetrahedron()}) {
    const TriangleMesh coarse = make_mesh(soup);
    const TriangleMesh fine = subdivide(coarse);
    ASSERT_EQ(fine.face_count(), 4 * coarse.face_count());
    for (std::uint32_t h = 0; h < fine.twins.size(); ++h) {
      const std::uint32_t twin = fine.twins[h];
      if (twin == kNone) continue;
      EXPECT_EQ(fine.twins[twin], h);
      EXPECT_EQ(fine.from(h), fine.to(twin));
      EXPECT_EQ(fine.to(h), fine.from(twin));
    }
    const Topology a = analyse_topology(coarse), b = analyse_topology(fine);
    EXPECT_EQ(a.genus, b.genus);
    EXPECT_EQ(a.boundary_loops, b.boundary_loops);
    EXPECT_EQ(a.components, b.components);
    std::vector<std::uint32_t> fans;
    EXPECT_EQ(label_fans(fine.twins, fans), fine.vertex_count());
  }
}

TEST(Subdivide, BringsASphereNearerToRound) {
  const TriangleMesh coarse = curvecast::testing::make_mesh(curvecast::testing::icosphere(1));
  const TriangleMesh fine = subdivide(coarse);
  const double round = 4 * std::numbers::pi;
  EXPECT_LT(std::abs(surface_area(fine) - round), 0.35 * std::abs(surface_area(coarse) - round));
}

TEST(Subdivide, LeavesAFlatMeshFlat) {
  const TriangleMesh coarse = curvecast::testing::make_mesh(curvecast::testing::disc(4, 12));
  EXPECT_NEAR(surface_area(subdivide(coarse)), surface_area(coarse), 1e-6);
}

}  // namespace
}  // namespace curvecast::cli::bench
