#include "core/mesh/curvature.h"

#include <cmath>
#include <numbers>

#include "core/mesh/principal_directions.h"

namespace curvecast {
namespace {

struct Corner {
  double angle, cotangent;
};

Corner corner_at(const Vec3d& apex, const Vec3d& p, const Vec3d& q) {
  const Vec3d u = p - apex;
  const Vec3d v = q - apex;
  const double sine = u.cross(v).norm();
  const double cosine = u.dot(v);
  // Slivers would let one cotangent outweigh the whole neighbourhood.
  constexpr double kLargestCotangent = 1e3;
  const double cotangent = std::clamp(cosine / std::max(sine, 1e-300), -kLargestCotangent, kLargestCotangent);
  return {std::atan2(sine, cosine), cotangent};
}

struct Accumulators {
  std::vector<Vec3d> normal, laplacian;
  std::vector<double> angle, mixed_area;
  std::vector<bool> border;

  explicit Accumulators(std::size_t n)
      : normal(n, Vec3d::Zero()), laplacian(n, Vec3d::Zero()), angle(n, 0.0), mixed_area(n, 0.0), border(n, false) {}
};

void add_face(const TriangleMesh& mesh, std::size_t f, Accumulators& sums) {
  const Triangle& t = mesh.triangles[f];
  const std::array<Vec3d, 3> p = {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
  const Vec3d cross = (p[1] - p[0]).cross(p[2] - p[0]);
  const double area = 0.5 * cross.norm();
  const Vec3d unit = cross / (2 * area);
  std::array<Corner, 3> corner;
  bool obtuse = false;
  for (int i = 0; i < 3; ++i) {
    corner[i] = corner_at(p[i], p[(i + 1) % 3], p[(i + 2) % 3]);
    obtuse |= corner[i].cotangent < 0;
  }
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    sums.normal[t[i]] += corner[i].angle * unit;
    sums.angle[t[i]] += corner[i].angle;
    sums.laplacian[t[i]] += corner[k].cotangent * (p[i] - p[j]) + corner[j].cotangent * (p[i] - p[k]);
    sums.mixed_area[t[i]] +=
        obtuse ? area / (corner[i].cotangent < 0 ? 2 : 4)
               : (corner[k].cotangent * (p[i] - p[j]).squaredNorm() + corner[j].cotangent * (p[i] - p[k]).squaredNorm()) / 8;
    if (mesh.twins[3 * f + i] == kNone) sums.border[t[i]] = sums.border[t[j]] = true;
  }
}

/// Border vertices take the mean over their inner neighbours, or zero where they have none.
void fill_borders(const TriangleMesh& mesh, const std::vector<bool>& border, std::vector<float>& values) {
  std::vector<double> sum(values.size(), 0.0);
  std::vector<int> count(values.size(), 0);
  for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
    for (const auto& [v, w] : {std::pair(mesh.from(h), mesh.to(h)), std::pair(mesh.to(h), mesh.from(h))}) {
      if (!border[v] || border[w]) continue;
      sum[v] += values[w];
      ++count[v];
    }
  }
  for (std::size_t v = 0; v < values.size(); ++v) {
    if (border[v]) values[v] = count[v] > 0 ? static_cast<float>(sum[v] / count[v]) : 0.0f;
  }
}

}  // namespace

DifferentialGeometry differential_geometry(const TriangleMesh& mesh) {
  const std::size_t n = mesh.vertex_count();
  Accumulators sums(n);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) add_face(mesh, f, sums);
  DifferentialGeometry geometry;
  geometry.normals.resize(n);
  geometry.curvature_min.resize(n);
  geometry.curvature_max.resize(n);
  for (std::size_t v = 0; v < n; ++v) {
    const double length = sums.normal[v].norm();
    const Vec3d normal = length > 0 ? Vec3d(sums.normal[v] / length) : Vec3d::UnitZ();
    geometry.normals[v] = normal.cast<float>();
    if (sums.border[v] || !(sums.mixed_area[v] > 0)) continue;
    const double gauss = (2 * std::numbers::pi - sums.angle[v]) / sums.mixed_area[v];
    // The Laplacian is twice the mean curvature normal; half its length, signed, is the mean curvature.
    const double mean = std::copysign(sums.laplacian[v].norm() / (4 * sums.mixed_area[v]), sums.laplacian[v].dot(normal));
    const double spread = std::sqrt(std::max(mean * mean - gauss, 0.0));
    geometry.curvature_min[v] = static_cast<float>(mean - spread);
    geometry.curvature_max[v] = static_cast<float>(mean + spread);
  }
  fill_borders(mesh, sums.border, geometry.curvature_min);
  fill_borders(mesh, sums.border, geometry.curvature_max);
  geometry.directions_max = principal_directions(mesh, geometry.normals);
  return geometry;
}

Vec3f face_normal(const TriangleMesh& mesh, std::uint32_t f) {
  const Triangle& t = mesh.triangles[f];
  const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
  return (b - a).cross(c - a).normalized().cast<float>();
}

}  // namespace curvecast
