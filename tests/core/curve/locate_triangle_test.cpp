#include "core/curve/locate_triangle.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/random.h"
#include "tests/core/curve/charts.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

std::vector<Chart> sample_charts() {
  std::vector<Chart> charts;
  for (const PolygonSoup& soup : {disc(8, 24), jittered(sphere(24, 30), 0.02), torus(24, 12), open_cylinder(20, 12, 5),
                                  perforated_slab(5, 3), single_triangle()}) {
    for (Chart& chart : charts_of(make_mesh(soup))) charts.push_back(std::move(chart));
  }
  return charts;
}

TEST(LocateTriangle, ArrivesFromAnywhere) {
  for (const Chart& chart : sample_charts()) {
    const Column<ParameterTriangle> triangles = parameter_triangles(chart);
    const ParameterMesh mesh(chart);
    const auto count = static_cast<double>(triangles.size());
    for (std::uint64_t i = 0; i < 2000; ++i) {
      const Vec2d p(random_unit(1, i), random_unit(2, i));
      const auto start = static_cast<std::uint32_t>(random_unit(3, i) * count);
      const std::uint32_t found = find_triangle(mesh, p, start);
      EXPECT_GE(triangles[found].weights(p.x(), p.y()).minCoeff(), -1e-12) << p.transpose() << " from " << start;
      EXPECT_EQ(find_triangle(mesh, p, found), found);
    }
  }
}

TEST(LocateTriangle, FourAtATimeArriveToo) {
  for (const Chart& chart : sample_charts()) {
    const Column<ParameterTriangle> triangles = parameter_triangles(chart);
    const ParameterMesh mesh(chart);
    const auto count = static_cast<double>(triangles.size());
    for (std::uint64_t i = 0; i < 2000; ++i) {
      // All over the square, or close together as siblings are; now and then one of them on a corner of the mesh.
      const double reach = i % 2 == 0 ? 1 : 0.01;
      double u[4], v[4];
      for (std::uint64_t k = 0; k < 4; ++k) {
        u[k] = std::min(random_unit(1, i) + reach * random_unit(4 + k, i), 1.0);
        v[k] = std::min(random_unit(2, i) + reach * random_unit(8 + k, i), 1.0);
      }
      const auto start = static_cast<std::uint32_t>(random_unit(3, i) * count);
      if (i % 10 == 0) {
        u[i % 4] = triangles[start].u[i % 3];
        v[i % 4] = triangles[start].v[i % 3];
      }
      std::uint32_t found[4];
      find_four_triangles(mesh, u, v, start, found);
      for (int k = 0; k < 4; ++k) {
        // In units of the triangle's own size.
        EXPECT_GE(triangles[found[k]].weights(u[k], v[k]).minCoeff(), -1e-6) << u[k] << " " << v[k] << " from " << start;
      }
    }
  }
}

TEST(LocateTriangle, CornersSidesAndBordersGoToOneOfTheirTriangles) {
  for (const Chart& chart : sample_charts()) {
    const Column<ParameterTriangle> triangles = parameter_triangles(chart);
    const ParameterMesh mesh(chart);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      const ParameterTriangle& p = triangles[t];
      for (int i = 0; i < 3; ++i) {
        const Vec2d corner(p.u[i], p.v[i]), middle(0.5 * (p.u[i] + p.u[(i + 1) % 3]), 0.5 * (p.v[i] + p.v[(i + 1) % 3]));
        for (const Vec2d& q : {corner, middle}) {
          const std::uint32_t found = find_triangle(mesh, q, (t * 7919) % static_cast<std::uint32_t>(triangles.size()));
          // In units of the triangle's own size.
          EXPECT_GE(triangles[found].weights(q.x(), q.y()).minCoeff(), -1e-6);
        }
      }
    }
  }
}

TEST(TouchingTriangles, AreThoseOfTheQuadtree) {
  for (const Chart& chart : sample_charts()) {
    const Column<ParameterTriangle> triangles = parameter_triangles(chart);
    for (const double vertices : {30.0, 3000.0}) {
      const absl::StatusOr<QuadtreeLeaves> leaves = build_quadtree(triangles, even_demand(chart, vertices), 1'000'000);
      ASSERT_TRUE(leaves.ok());
      TouchingTriangles touching{ParameterMesh(chart)};
      std::vector<std::uint32_t> found;
      for (std::size_t l = 0; l < leaves->size(); ++l) {
        touching.find(leaf_quad(leaves->key[l], leaves->level[l]), static_cast<std::uint32_t>(l % triangles.size()), found);
        const std::span listed = leaves->triangles_of(l);
        EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
        // Those that do no more than touch are a matter of rounding.
        std::vector<std::uint32_t> differ;
        std::set_symmetric_difference(found.begin(), found.end(), listed.begin(), listed.end(), std::back_inserter(differ));
        const Quad quad = leaf_quad(leaves->key[l], leaves->level[l]);
        for (const std::uint32_t t : differ) {
          const double margin = 1e-9;
          const Quad smaller{quad.corner + Vec2d::Constant(margin * quad.side), quad.side * (1 - 2 * margin)};
          EXPECT_FALSE(touches(triangles[t], smaller));
        }
      }
    }
  }
}

}  // namespace
}  // namespace curvecast
