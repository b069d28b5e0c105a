#include "core/curve/surface_map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

namespace curvecast {
namespace {

double cross2(const Vec2d& p, const Vec2d& q) { return p.x() * q.y() - p.y() * q.x(); }

/// Barycentric coordinates of p, each at least 0 where p lies inside.
Vec3d barycentric(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& p) {
  const double area = cross2(b - a, c - a);
  const double u = cross2(b - p, c - p) / area;
  const double v = cross2(c - p, a - p) / area;
  return {u, v, 1 - u - v};
}

Vec3d clamped(const Vec3d& weights) {
  const Vec3d positive = weights.cwiseMax(0.0);
  return positive / positive.sum();
}

/// The triangle that holds p and where in it: of the candidates the one in which p lies deepest, so that rounding on a shared
/// side does no harm.
struct Hit {
  std::uint32_t triangle = 0;
  Vec3d weights = Vec3d::Zero();
};

Hit locate(const Chart& chart, std::span<const std::uint32_t> candidates, const Vec2d& p) {
  Hit best;
  double deepest = -std::numeric_limits<double>::infinity();
  for (const std::uint32_t t : candidates) {
    const Triangle& v = chart.disc.triangles[t];
    const Vec3d weights = barycentric(chart.uv[v[0]], chart.uv[v[1]], chart.uv[v[2]], p);
    const double depth = weights.minCoeff();
    if (depth > deepest) {
      deepest = depth;
      best = {t, weights};
      if (depth > 0) break;
    }
  }
  best.weights = clamped(best.weights);
  return best;
}

/// Weights of a point on face f; the disc's triangle may be a part of the face only.
Vec3d weights_on_face(const TriangleMesh& mesh, std::uint32_t f, const Vec3d& p) {
  const Triangle& t = mesh.triangles[f];
  const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
  const Vec3d normal = (b - a).cross(c - a);
  const double square = normal.squaredNorm();
  const double u = (b - p).cross(c - p).dot(normal) / square;
  const double v = (c - p).cross(a - p).dot(normal) / square;
  return clamped({u, v, 1 - u - v});
}

}  // namespace

void map_to_surface(const TriangleMesh& mesh, const DifferentialGeometry& geometry, const Chart& chart,
                    const QuadtreeLeaves& leaves, std::size_t offset, SurfaceCurve& curve, const SurfaceColour* colour) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.size(), 4096), [&](const auto& range) {
    for (std::size_t l = range.begin(); l < range.end(); ++l) {
      const Quad quad = leaf_quad(leaves.key[l], leaves.level[l]);
      const std::span candidates(leaves.triangles.data() + leaves.triangle_begin[l],
                                 leaves.triangle_begin[l + 1] - leaves.triangle_begin[l]);
      const Hit hit = locate(chart, candidates, quad.corner + Vec2d::Constant(0.5 * quad.side));
      const Triangle& v = chart.disc.triangles[hit.triangle];
      const Vec3d place = hit.weights[0] * chart.disc.positions[v[0]] + hit.weights[1] * chart.disc.positions[v[1]] +
                          hit.weights[2] * chart.disc.positions[v[2]];
      const std::uint32_t face = chart.disc.face_of[hit.triangle];
      const Vec3f w = weights_on_face(mesh, face, place).cast<float>();
      const Triangle& m = mesh.triangles[face];
      const Vec3f sum = w[0] * geometry.normals[m[0]] + w[1] * geometry.normals[m[1]] + w[2] * geometry.normals[m[2]];
      const float length = sum.norm();
      const Vec3f normal = length > 0 ? Vec3f(sum / length) : geometry.normals[m[0]];
      const auto mix = [&](const std::vector<float>& values) {
        return w[0] * values[m[0]] + w[1] * values[m[1]] + w[2] * values[m[2]];
      };
      const Vec3f position = (place - curve.origin).cast<float>();
      const std::size_t i = offset + l;
      curve.x[i] = position.x();
      curve.y[i] = position.y();
      curve.z[i] = position.z();
      curve.nx[i] = normal.x();
      curve.ny[i] = normal.y();
      curve.nz[i] = normal.z();
      curve.curvature_min[i] = mix(geometry.curvature_min);
      curve.curvature_max[i] = mix(geometry.curvature_max);
      if (colour != nullptr) curve.colour[i] = colour->at(face, w, quad.side * quad.side * chart.area_ratio[hit.triangle]);
      curve.triangle[i] = face;
      curve.weight_1[i] = w[1];
      curve.weight_2[i] = w[2];
      curve.key[i] = leaves.key[l];
      curve.level[i] = leaves.level[l];
    }
  });
}

}  // namespace curvecast
