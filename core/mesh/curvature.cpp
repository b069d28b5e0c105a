#include "core/mesh/curvature.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/mesh/principal_directions.h"
#include "core/mesh/vertex_fans.h"

namespace curvecast {
namespace {

constexpr std::size_t kGrain = 4096;  // vertices

/// The angle of a triangle's corner, as its sine and cosine times the lengths of the sides there.
struct Corner {
  double sine, cosine;

  Corner(const Vec3d& apex, const Vec3d& p, const Vec3d& q) {
    const Vec3d u = p - apex;
    const Vec3d v = q - apex;
    sine = std::sqrt(u.cross(v).squaredNorm());
    cosine = u.dot(v);
  }
  double angle() const { return std::atan2(sine, cosine); }
  double cotangent() const {
    // Slivers would let one cotangent outweigh the whole neighbourhood.
    constexpr double kLargestCotangent = 1e3;
    return std::clamp(cosine / std::max(sine, 1e-300), -kLargestCotangent, kLargestCotangent);
  }
};

/// What the faces around a vertex add up to.
struct Sums {
  Vec3d normal = Vec3d::Zero(), laplacian = Vec3d::Zero();
  double angle = 0, mixed_area = 0;

  /// The face's corner i is at the vertex. What a face has is found for each of its vertices anew: kept for all faces it would
  /// take more memory than the mesh, and no less time.
  void add(const TriangleMesh& mesh, std::uint32_t f, int i) {
    const Triangle& t = mesh.triangles[f];
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const Vec3d &a = mesh.positions[t[i]], &b = mesh.positions[t[j]], &c = mesh.positions[t[k]];
    const Vec3d to_j = a - b, to_k = a - c;
    const Vec3d cross = to_j.cross(to_k);
    const double twice_area = std::sqrt(cross.squaredNorm());
    const Corner at_a(a, b, c);
    const double own_angle = at_a.angle();
    const double cotangent = at_a.cotangent(), cotangent_j = Corner(b, c, a).cotangent(),
                 cotangent_k = Corner(c, a, b).cotangent();
    normal += own_angle / twice_area * cross;
    angle += own_angle;
    laplacian += cotangent_k * to_j + cotangent_j * to_k;
    const bool obtuse = cotangent < 0 || cotangent_j < 0 || cotangent_k < 0;
    mixed_area +=
        obtuse ? twice_area / (cotangent < 0 ? 4 : 8) : (cotangent_k * to_j.squaredNorm() + cotangent_j * to_k.squaredNorm()) / 8;
  }
};

/// Border vertices take the mean over their inner neighbours, or zero where they have none.
void fill_borders(const TriangleMesh& mesh, const VertexFans& fans, std::vector<float>& values) {
  // From the values of inner vertices only, so the order does not matter.
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, values.size(), kGrain), [&](const auto& range) {
    for (std::size_t v = range.begin(); v < range.end(); ++v) {
      if (!fans.on_border(v)) continue;
      double sum = 0;
      int count = 0;
      const auto add = [&](std::uint32_t w) {
        if (fans.on_border(w)) return;
        sum += values[w];
        ++count;
      };
      fans.visit(v, [&](std::uint32_t h) { add(mesh.to(h)); });
      values[v] = count > 0 ? static_cast<float>(sum / count) : 0.0f;
    }
  });
}

}  // namespace

DifferentialGeometry differential_geometry(const TriangleMesh& mesh) {
  const std::size_t n = mesh.vertex_count();
  const VertexFans fans(mesh);
  DifferentialGeometry geometry;
  geometry.normals.resize(n);
  geometry.curvature_min.resize(n);
  geometry.curvature_max.resize(n);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, kGrain), [&](const auto& range) {
    for (std::size_t v = range.begin(); v < range.end(); ++v) {
      Sums sums;
      fans.visit(v, [&](std::uint32_t h) { sums.add(mesh, h / 3, static_cast<int>(h % 3)); });
      const double length = sums.normal.norm();
      const Vec3d normal = length > 0 ? Vec3d(sums.normal / length) : Vec3d::UnitZ();
      geometry.normals[v] = normal.cast<float>();
      if (fans.on_border(v) || !(sums.mixed_area > 0)) continue;
      const double gauss = (2 * std::numbers::pi - sums.angle) / sums.mixed_area;
      // The Laplacian is twice the mean curvature normal; half its length, signed, is the mean curvature.
      const double mean = std::copysign(sums.laplacian.norm() / (4 * sums.mixed_area), sums.laplacian.dot(normal));
      const double spread = std::sqrt(std::max(mean * mean - gauss, 0.0));
      geometry.curvature_min[v] = static_cast<float>(mean - spread);
      geometry.curvature_max[v] = static_cast<float>(mean + spread);
    }
  });
  fill_borders(mesh, fans, geometry.curvature_min);
  fill_borders(mesh, fans, geometry.curvature_max);
  geometry.directions_max = principal_directions(mesh, fans, geometry.normals);
  return geometry;
}

Vec3f face_normal(const TriangleMesh& mesh, std::uint32_t f) {
  const Triangle& t = mesh.triangles[f];
  const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
  return (b - a).cross(c - a).normalized().cast<float>();
}

}  // namespace curvecast
