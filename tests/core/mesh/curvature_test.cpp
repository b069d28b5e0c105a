#include "core/mesh/curvature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

constexpr double kPi = std::numbers::pi;

void expect_unit(std::span<const VertexGeometry> geometry) {
  for (const VertexGeometry& vertex : geometry) EXPECT_NEAR(vertex.normal.norm(), 1, 1e-6);
}

/// The integral of the Gaussian curvature, every vertex with a third of its faces' area.
double total_gauss(const TriangleMesh& mesh, std::span<const VertexGeometry> geometry) {
  double sum = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    for (const std::uint32_t v : mesh.triangles[f]) {
      sum += triangle_area(mesh, f) / 3 * geometry[v].curvature_min * geometry[v].curvature_max;
    }
  }
  return sum;
}

TEST(Curvature, OfSpheresIsOneOverTheRadius) {
  for (const double radius : {1e-3, 1.0, 250.0}) {
    const TriangleMesh mesh = make_mesh(icosphere(5, radius));
    const std::vector<VertexGeometry> geometry = differential_geometry(mesh);
    expect_unit(geometry);
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      EXPECT_NEAR(geometry[v].curvature_min * radius, 1, 0.05) << "vertex " << v;
      EXPECT_NEAR(geometry[v].curvature_max * radius, 1, 0.05) << "vertex " << v;
      EXPECT_LE(geometry[v].curvature_min, geometry[v].curvature_max);
      EXPECT_GT(geometry[v].normal.cast<double>().dot(mesh.positions[v] / radius), 0.999) << "vertex " << v;
    }
  }
}

TEST(Curvature, IsNegativeInsideASphere) {
  PolygonSoup soup = icosphere(3);
  for (std::size_t i = 0; i < soup.indices.size(); i += 3) std::swap(soup.indices[i], soup.indices[i + 1]);
  const std::vector<VertexGeometry> geometry = differential_geometry(make_mesh(soup));
  for (std::size_t v = 0; v < geometry.size(); ++v) {
    EXPECT_LT(geometry[v].curvature_max, -0.7f) << "vertex " << v;
    EXPECT_GT(geometry[v].curvature_min, -1.3f) << "vertex " << v;
  }
}

TEST(Curvature, OfACylinder) {
  const TriangleMesh mesh = make_mesh(open_cylinder(20, 80));
  const std::vector<VertexGeometry> geometry = differential_geometry(mesh);
  expect_unit(geometry);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {  // the border takes its neighbours' values
    EXPECT_NEAR(geometry[v].curvature_max, 1, 0.01) << "vertex " << v;
    EXPECT_NEAR(geometry[v].curvature_min, 0, 0.01) << "vertex " << v;
    const Vec3d& p = mesh.positions[v];
    EXPECT_GT(geometry[v].normal.cast<double>().dot(Vec3d(p.x(), p.y(), 0)), 0.99) << "vertex " << v;
  }
}

TEST(Curvature, OfAPlaneIsZero) {
  const TriangleMesh mesh = make_mesh(translated(disc(12, 31), {3, -2, 5}));
  const std::vector<VertexGeometry> geometry = differential_geometry(mesh);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    EXPECT_NEAR(geometry[v].curvature_min, 0, 1e-4) << "vertex " << v;
    EXPECT_NEAR(geometry[v].curvature_max, 0, 1e-4) << "vertex " << v;
    EXPECT_NEAR(geometry[v].normal.z(), 1, 1e-6) << "vertex " << v;
  }
}

TEST(Curvature, OfATorusChangesSign) {
  const double tube = 0.3;
  const TriangleMesh mesh = make_mesh(torus(160, 64, tube));
  const std::vector<VertexGeometry> geometry = differential_geometry(mesh);
  expect_unit(geometry);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3d& p = mesh.positions[v];
    const double reach = std::hypot(p.x(), p.y());  // from the axis
    const double cosine = (reach - 1) / tube;
    EXPECT_NEAR(geometry[v].curvature_max, 1 / tube, 0.05 / tube) << "vertex " << v;
    EXPECT_NEAR(geometry[v].curvature_min, cosine / reach, 0.05 / tube) << "vertex " << v;
    if (std::abs(cosine) > 0.3) {
      EXPECT_EQ(geometry[v].curvature_min > 0, cosine > 0) << "vertex " << v;
    }
    const Vec3d outward = Vec3d(p.x() * (1 - 1 / reach), p.y() * (1 - 1 / reach), p.z()) / tube;
    EXPECT_GT(geometry[v].normal.cast<double>().dot(outward), 0.99) << "vertex " << v;
  }
}

TEST(Curvature, AddsUpToTheEulerCharacteristic) {
  const TriangleMesh ball = make_mesh(icosphere(4, 3));
  EXPECT_NEAR(total_gauss(ball, differential_geometry(ball)), 4 * kPi, 0.01 * 4 * kPi);
  const TriangleMesh ring = make_mesh(torus(160, 64));
  EXPECT_NEAR(total_gauss(ring, differential_geometry(ring)), 0, 0.01 * 8 * kPi);  // 4 pi outside, -4 pi inside
}

TEST(Curvature, StaysFiniteOnRoughAndTinyMeshes) {
  for (const PolygonSoup& soup : {single_triangle(), tetrahedron(), cube(), mobius_strip(3), jittered(sphere(20, 30), 0.2),
                                  jittered(torus(9, 40), 1e-3), scaled(icosphere(2), 1e-12), scaled(icosphere(2), 1e14)}) {
    const std::vector<VertexGeometry> geometry = differential_geometry(make_mesh(soup));
    expect_unit(geometry);
    for (std::size_t v = 0; v < geometry.size(); ++v) {
      EXPECT_TRUE(std::isfinite(geometry[v].curvature_min) && std::isfinite(geometry[v].curvature_max)) << "vertex " << v;
      EXPECT_LE(geometry[v].curvature_min, geometry[v].curvature_max);
    }
  }
}

TEST(Curvature, WithoutInnerVerticesIsZero) {
  const std::vector<VertexGeometry> geometry = differential_geometry(make_mesh(single_triangle()));
  for (std::size_t v = 0; v < 3; ++v) {
    EXPECT_EQ(geometry[v].curvature_min, 0);
    EXPECT_EQ(geometry[v].curvature_max, 0);
  }
}

}  // namespace
}  // namespace curvecast
