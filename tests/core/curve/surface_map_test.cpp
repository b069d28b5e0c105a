#include "core/curve/surface_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <iterator>
#include <memory>

#include "tests/core/curve/charts.h"

namespace curvecast {
namespace {

using testing::charts_of;
using testing::even_demand;
using testing::make_mesh;

struct Mapped {
  TriangleMesh mesh;
  Chart chart;
  QuadtreeLeaves leaves;
  SurfaceCurve curve;
};

/// Maps the leaves, with what the attributes give.
void map_again(Mapped& mapped, const MeshAttributes& attributes = {}, const SurfaceColour* colour = nullptr) {
  const Column<ParameterTriangle> triangles = parameter_triangles(mapped.chart);
  std::vector<std::uint32_t> under(mapped.leaves.size());
  locate_centres(triangles, mapped.leaves, under);
  mapped.curve.scalars.clear();
  for (const ScalarAttribute& scalar : attributes.scalars) mapped.curve.scalars.push_back({scalar.name, {}});
  mapped.curve.resize(mapped.leaves.size(), colour != nullptr);
  const std::vector<VertexGeometry> geometry = differential_geometry(mapped.mesh);
  const CreaseNormals creases = crease_normals(mapped.mesh);
  const SurfaceData data{mapped.mesh, geometry, creases, attributes, colour};
  const Column<std::uint8_t> kinds = triangle_kinds(data, mapped.chart);
  map_to_surface(SurfaceMapper(data, mapped.chart, kinds), mapped.leaves, under, 0, mapped.curve);
}

Mapped map_shape(const PolygonSoup& soup, double vertices, const Vec3d& origin = Vec3d::Zero()) {
  Mapped mapped;
  mapped.mesh = make_mesh(soup);
  mapped.chart = std::move(charts_of(mapped.mesh)[0]);
  const Column<ParameterTriangle> triangles = parameter_triangles(mapped.chart);
  absl::StatusOr<QuadtreeLeaves> leaves = build_quadtree(triangles, even_demand(mapped.chart, vertices), 1'000'000);
  EXPECT_TRUE(leaves.ok());
  mapped.leaves = *std::move(leaves);
  mapped.curve.origin = origin;
  map_again(mapped);
  return mapped;
}

Vec3d position(const SurfaceCurve& curve, std::size_t l) { return curve.origin + Vec3d(curve.x[l], curve.y[l], curve.z[l]); }

TEST(SurfaceMap, PutsEveryVertexInsideItsFace) {
  using namespace testing;
  for (const PolygonSoup& soup :
       {disc(8, 24), jittered(sphere(24, 30), 0.02), torus(24, 12), perforated_slab(5, 3), single_triangle()}) {
    const Mapped m = map_shape(soup, 5'000);
    for (std::size_t l = 0; l < m.curve.size(); ++l) {
      const Triangle& t = m.mesh.triangles[m.curve.triangle[l]];
      const Vec3d &a = m.mesh.positions[t[0]], &b = m.mesh.positions[t[1]], &c = m.mesh.positions[t[2]];
      const Vec3d p = position(m.curve, l);
      const double whole = (b - a).cross(c - a).norm();
      const double parts = (b - p).cross(c - p).norm() + (c - p).cross(a - p).norm() + (a - p).cross(b - p).norm();
      EXPECT_NEAR(parts, whole, 1e-5) << "the parts make up the face only where the point lies in it";
    }
  }
}

TEST(SurfaceMap, FollowsTheParameterMesh) {
  // Map the centre of each leaf by brute force over all triangles.
  const Mapped m = map_shape(testing::jittered(testing::torus(16, 10), 0.02), 800);
  for (std::size_t l = 0; l < m.curve.size(); ++l) {
    const Quad quad = leaf_quad(m.leaves.key[l], m.leaves.level[l]);
    const Vec2d p = quad.corner + Vec2d::Constant(0.5 * quad.side);
    double nearest = 1e300;
    for (const Triangle& t : m.chart.disc.triangles) {
      Eigen::Matrix3d system;
      system << m.chart.uv[t[0]].x(), m.chart.uv[t[1]].x(), m.chart.uv[t[2]].x(),  //
          m.chart.uv[t[0]].y(), m.chart.uv[t[1]].y(), m.chart.uv[t[2]].y(),        //
          1, 1, 1;
      const Vec3d w = system.inverse() * Vec3d(p.x(), p.y(), 1);
      if (w.minCoeff() < -1e-9) continue;
      const auto& places = m.chart.disc.positions;
      nearest =
          std::min(nearest, (w[0] * places[t[0]] + w[1] * places[t[1]] + w[2] * places[t[2]] - position(m.curve, l)).norm());
    }
    EXPECT_LT(nearest, 1e-6);
  }
}

TEST(SurfaceMap, InterpolatesNormalsAndCurvatures) {
  const Mapped m = map_shape(testing::sphere(60, 90, 2), 5'000);
  for (std::size_t l = 0; l < m.curve.size(); ++l) {
    const Vec3d normal(m.curve.nx[l], m.curve.ny[l], m.curve.nz[l]);
    EXPECT_NEAR(normal.norm(), 1, 5e-5);  // packed
    EXPECT_GT(normal.dot(position(m.curve, l).normalized()), 0.99);
    const bool near_pole = std::abs(m.curve.z[l]) > 1.8;  // where the mesh's triangles are needles
    EXPECT_NEAR(m.curve.curvature_max[l], 0.5, near_pole ? 0.5 : 0.05);
  }
}

TEST(SurfaceMap, BakesTheColourOfEveryPlace) {
  // Red grows with x, green with y, in a texture laid flat over a disc of radius 1.
  constexpr int kSide = 64;
  auto texture = std::make_shared<Image>(Image{kSide, kSide, {}});
  const auto level = [](double t) { return static_cast<std::uint8_t>(std::lround(255 * t)); };
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      const std::uint8_t texel[] = {level((column + 0.5) / kSide), level(1 - (row + 0.5) / kSide), 7, 255};
      texture->rgba.insert(texture->rgba.end(), std::begin(texel), std::end(texel));
    }
  }
  Mapped m = map_shape(testing::disc(8, 24), 5'000);
  MeshAttributes attributes;
  attributes.materials = {{"flat", {}, texture}};
  attributes.material_of_face.assign(m.mesh.face_count(), 0);
  const auto uv_of = [](double t) { return 0.1 + 0.4 * (t + 1); };  // stays clear of the texture's edges
  for (const Triangle& t : m.mesh.triangles) {
    for (const std::uint32_t v : t) {
      const Vec3d& p = m.mesh.positions[v];
      attributes.uv.push_back(Vec2d(uv_of(p.x()), uv_of(p.y())).cast<float>());
    }
  }
  const SurfaceColour colour(m.mesh, attributes);
  map_again(m, attributes, &colour);
  for (std::size_t l = 0; l < m.curve.size(); ++l) {
    const Vec3d p = position(m.curve, l);
    EXPECT_NEAR(m.curve.colour[l].r, 255 * uv_of(p.x()), 4);
    EXPECT_NEAR(m.curve.colour[l].g, 255 * uv_of(p.y()), 4);
    EXPECT_EQ(m.curve.colour[l].b, 7);
  }
  EXPECT_EQ(m.curve.byte_size(), map_shape(testing::disc(8, 24), 5'000).curve.byte_size() + 4 * m.curve.size());
}

TEST(SurfaceMap, InterpolatesScalarsAndTheWeightsThatItKeeps) {
  Mapped m = map_shape(testing::jittered(testing::torus(24, 12), 0.02), 5'000);
  MeshAttributes attributes;
  attributes.scalars = {{"height", {}}, {"width", {}}};
  for (const Vec3d& p : m.mesh.positions) {
    attributes.scalars[0].values.push_back(static_cast<float>(p.z()));
    attributes.scalars[1].values.push_back(static_cast<float>(p.x()));
  }
  map_again(m, attributes);
  ASSERT_EQ(m.curve.scalars.size(), 2u);
  for (std::size_t l = 0; l < m.curve.size(); ++l) {
    EXPECT_NEAR(m.curve.scalars[0].values[l], m.curve.z[l], 1e-5);
    EXPECT_NEAR(m.curve.scalars[1].values[l], m.curve.x[l], 1e-5);
    const Triangle& t = m.mesh.triangles[m.curve.triangle[l]];
    const double w1 = m.curve.weight_1[l], w2 = m.curve.weight_2[l];
    const Vec3d p = (1 - w1 - w2) * m.mesh.positions[t[0]] + w1 * m.mesh.positions[t[1]] + w2 * m.mesh.positions[t[2]];
    EXPECT_LT((p - position(m.curve, l)).norm(), 1e-4);
  }
}

TEST(SurfaceMap, KeepsItsDigitsFarFromTheOrigin) {
  const Vec3d far(1e7, -2e7, 3e7);
  const Mapped m = map_shape(testing::translated(testing::sphere(20, 30), far), 2'000, far);
  for (std::size_t l = 0; l < m.curve.size(); ++l) {
    const double radius = Vec3d(m.curve.x[l], m.curve.y[l], m.curve.z[l]).norm();
    EXPECT_LT(radius, 1 + 1e-5);
    EXPECT_GT(radius, 0.97);
  }
}

}  // namespace
}  // namespace curvecast
