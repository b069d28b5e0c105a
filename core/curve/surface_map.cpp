#include "core/curve/surface_map.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <vector>

#include "core/curve/deepest_triangle.h"
#include "core/curve/tangent_frame.h"

namespace curvecast {
namespace {

constexpr std::size_t kGrain = 4096;  // leaves

Vec3d clamped(const Vec3d& weights) {
  if (weights.minCoeff() >= 0) return weights;
  const Vec3d positive = weights.cwiseMax(0.0);
  return positive / positive.sum();
}

/// Weights of a point on face f.
Vec3d weights_on_face(const TriangleMesh& mesh, std::uint32_t f, const Vec3d& p) {
  const Triangle& t = mesh.triangles[f];
  const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
  const Vec3d normal = (b - a).cross(c - a);
  const double square = normal.squaredNorm();
  const double u = (b - p).cross(c - p).dot(normal) / square;
  const double v = (c - p).cross(a - p).dot(normal) / square;
  return clamped({u, v, 1 - u - v});
}

/// For each triangle of a disc whether it is its whole face, corner by corner, and not a part of it.
std::vector<std::uint8_t> whole_faces(const TriangleMesh& mesh, const DiscMesh& disc) {
  std::vector<std::uint8_t> is_whole(disc.triangles.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, is_whole.size(), kGrain), [&](const auto& range) {
    for (std::size_t t = range.begin(); t < range.end(); ++t) {
      const Triangle& v = disc.triangles[t];
      const Triangle& corners = mesh.triangles[disc.face_of[t]];
      is_whole[t] = disc.positions[v[0]] == mesh.positions[corners[0]] && disc.positions[v[1]] == mesh.positions[corners[1]] &&
                    disc.positions[v[2]] == mesh.positions[corners[2]];
    }
  });
  return is_whole;
}

template <typename Values>
auto mix(const Values& values, const Triangle& corners, const Vec3f& w) {
  return w[0] * values[corners[0]] + w[1] * values[corners[1]] + w[2] * values[corners[2]];
}

Vec3f normal_at(const std::vector<Vec3f>& normals, const Triangle& corners, const Vec3f& w) {
  const Vec3f sum = mix(normals, corners, w);
  const float square = sum.squaredNorm();
  return square > 0 ? Vec3f(sum * (1 / std::sqrt(square))) : normals[corners[0]];
}

}  // namespace

void locate_centres(std::span<const ParameterTriangle> triangles, const QuadtreeLeaves& leaves, std::span<std::uint32_t> under) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.size(), kGrain), [&](const auto& range) {
    for (std::size_t l = range.begin(); l < range.end(); ++l) {
      const std::span candidates = leaves.triangles_of(l);
      under[l] = candidates[0];
      if (candidates.size() == 1) continue;
      const double half = 0.5 * side_of_level(leaves.level[l]);
      const double u = leaves.x[l] * kCellSide + half, v = leaves.y[l] * kCellSide + half;
      under[l] = deepest_triangle(triangles, candidates, u, v);
    }
  });
}

void map_to_surface(const SurfaceData& data, const Chart& chart, std::span<const ParameterTriangle> triangles,
                    const QuadtreeLeaves& leaves, std::span<const std::uint32_t> under, std::size_t offset, SurfaceCurve& curve) {
  const TriangleMesh& mesh = data.mesh;
  const DiscMesh& disc = chart.disc;
  const std::vector<std::uint8_t> is_whole = whole_faces(mesh, disc);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.size(), kGrain), [&](const auto& range) {
    for (std::size_t l = range.begin(); l < range.end(); ++l) {
      const double side = side_of_level(leaves.level[l]);
      const ParameterTriangle& triangle = triangles[under[l]];
      const Vec3d weights = clamped(triangle.weights(leaves.x[l] * kCellSide + 0.5 * side, leaves.y[l] * kCellSide + 0.5 * side));
      const Triangle& v = disc.triangles[under[l]];
      const Vec3d place =
          weights[0] * disc.positions[v[0]] + weights[1] * disc.positions[v[1]] + weights[2] * disc.positions[v[2]];
      const std::uint32_t face = disc.face_of[under[l]];
      const Triangle& corners = mesh.triangles[face];
      const Vec3f w = (is_whole[under[l]] ? weights : weights_on_face(mesh, face, place)).cast<float>();
      const Vec3f normal = normal_at(data.geometry.normals, corners, w);
      const Vec3f position = (place - curve.origin).cast<float>();
      const std::size_t i = offset + l;
      curve.x[i] = position.x();
      curve.y[i] = position.y();
      curve.z[i] = position.z();
      curve.nx[i] = normal.x();
      curve.ny[i] = normal.y();
      curve.nz[i] = normal.z();
      curve.curvature_min[i] = mix(data.geometry.curvature_min, corners, w);
      curve.curvature_max[i] = mix(data.geometry.curvature_max, corners, w);
      const std::vector<Vec3f>& directions = data.geometry.directions_max;
      const Vec3f axes[3] = {directions[corners[0]], directions[corners[1]], directions[corners[2]]};
      curve.direction[i] = mix_directions(axes, w, curve.normal(i));  // in the frame of the packed normal
      curve.triangle[i] = face;
      curve.weight_1[i] = w[1];
      curve.weight_2[i] = w[2];
      curve.key[i] = leaves.key[l];
      curve.level[i] = leaves.level[l];
      if (data.colour != nullptr) curve.colour[i] = data.colour->at(face, w, side * side * triangle.area_ratio);
      for (std::size_t s = 0; s < curve.scalars.size(); ++s) {
        curve.scalars[s].values[i] = mix(data.attributes.scalars[s].values, corners, w);
      }
    }
  });
}

}  // namespace curvecast
