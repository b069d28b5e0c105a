#include "core/mesh/curvature.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/for_all.h"
#include "core/mesh/principal_directions.h"

namespace curvecast {
namespace {

constexpr std::size_t kGrain = 4096;  // vertices

/// Returns the cotangent of an angle that has this sine and cosine, times anything.
double cotangent(double sine, double cosine) {
  // Slivers would let one cotangent outweigh the whole neighbourhood.
  constexpr double kLargestCotangent = 1e3;
  return std::clamp(cosine / std::max(sine, 1e-300), -kLargestCotangent, kLargestCotangent);
}

/// A sum of the normals of faces around a vertex, by their angles there.
struct NormalSum {
  Vec3d sum = Vec3d::Zero();

  /// `cross`: of two sides from the vertex, whose length is `twice_area`. Returns the angle between them.
  double add(const Vec3d& cross, double twice_area, double cosine) {
    const double angle = std::atan2(twice_area, cosine);
    sum += angle / twice_area * cross;
    return angle;
  }
  Vec3d normal() const {
    const double length = sum.norm();
    return length > 0 ? Vec3d(sum / length) : Vec3d::UnitZ();
  }
};

/// What the faces around a vertex add up to.
struct Sums {
  NormalSum normals;
  Vec3d laplacian = Vec3d::Zero();
  double angle = 0, mixed_area = 0;

  /// The face's corner i is at the vertex. What a face has is found for each of its vertices anew: kept for all faces it would
  /// take more memory than the mesh, and no less time.
  void add(const TriangleMesh& mesh, std::uint32_t f, int i) {
    const Triangle& t = mesh.triangles[f];
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const Vec3d &a = mesh.positions[t[i]], &b = mesh.positions[t[j]], &c = mesh.positions[t[k]];
    const Vec3d to_j = a - b, to_k = a - c, across = b - c;
    const Vec3d cross = to_j.cross(to_k);
    const double twice_area = std::sqrt(cross.squaredNorm());
    // Of the angles at a, b and c, times the lengths of the sides there.
    const double cosine = to_j.dot(to_k), cosine_j = -to_j.dot(across), cosine_k = to_k.dot(across);
    const double sine_j = std::sqrt(across.cross(to_j).squaredNorm()), sine_k = std::sqrt(to_k.cross(across).squaredNorm());
    const double cotangent_j = cotangent(sine_j, cosine_j), cotangent_k = cotangent(sine_k, cosine_k);
    angle += normals.add(cross, twice_area, cosine);
    laplacian += cotangent_k * to_j + cotangent_j * to_k;
    const bool obtuse = cosine < 0 || cosine_j < 0 || cosine_k < 0;
    mixed_area +=
        obtuse ? twice_area / (cosine < 0 ? 4 : 8) : (cotangent_k * to_j.squaredNorm() + cotangent_j * to_k.squaredNorm()) / 8;
  }
};

/// Border vertices take the mean over their inner neighbours, or zero where they have none.
void fill_borders(const TriangleMesh& mesh, const VertexFans& fans, float VertexGeometry::*curvature,
                  const ExecutionContext& context, std::vector<VertexGeometry>& geometry) {
  // From the values of inner vertices only, so the order does not matter.
  for_blocks(context, geometry.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      if (!fans.on_border(v)) continue;
      double sum = 0;
      int count = 0;
      const auto add = [&](std::uint32_t w) {
        if (fans.on_border(w)) return;
        sum += geometry[w].*curvature;
        ++count;
      };
      fans.visit(v, [&](std::uint32_t h) { add(mesh.to(h)); });
      geometry[v].*curvature = count > 0 ? static_cast<float>(sum / count) : 0.0f;
    }
  });
}

}  // namespace

std::vector<VertexGeometry> differential_geometry(const TriangleMesh& mesh) {
  return differential_geometry(mesh, VertexFans(mesh), {});
}

std::vector<VertexGeometry> differential_geometry(const TriangleMesh& mesh, const VertexFans& fans,
                                                  const ExecutionContext& context) {
  const std::size_t n = mesh.vertex_count();
  std::vector<VertexGeometry> geometry(n);
  for_blocks(context, n, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      Sums sums;
      fans.visit(v, [&](std::uint32_t h) { sums.add(mesh, h / 3, static_cast<int>(h % 3)); });
      const Vec3d normal = sums.normals.normal();
      geometry[v].normal = normal.cast<float>();
      if (fans.on_border(v) || !(sums.mixed_area > 0)) continue;
      const double gauss = (2 * std::numbers::pi - sums.angle) / sums.mixed_area;
      // The Laplacian is twice the mean curvature normal; half its length, signed, is the mean curvature.
      const double mean = std::copysign(sums.laplacian.norm() / (4 * sums.mixed_area), sums.laplacian.dot(normal));
      const double spread = std::sqrt(std::max(mean * mean - gauss, 0.0));
      geometry[v].curvature_min = static_cast<float>(mean - spread);
      geometry[v].curvature_max = static_cast<float>(mean + spread);
    }
  });
  fill_borders(mesh, fans, &VertexGeometry::curvature_min, context, geometry);
  fill_borders(mesh, fans, &VertexGeometry::curvature_max, context, geometry);
  principal_directions(mesh, fans, context, geometry);
  return geometry;
}

std::vector<VertexGeometry> vertex_normals(const TriangleMesh& mesh, const VertexFans& fans, const ExecutionContext& context) {
  std::vector<VertexGeometry> geometry(mesh.vertex_count());
  for_blocks(context, geometry.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      NormalSum normals;
      fans.visit(v, [&](std::uint32_t h) {
        const Vec3d& at = mesh.positions[v];
        const Vec3d to_j = at - mesh.positions[mesh.to(h)], to_k = at - mesh.positions[mesh.from(previous_halfedge(h))];
        const Vec3d cross = to_j.cross(to_k);
        normals.add(cross, std::sqrt(cross.squaredNorm()), to_j.dot(to_k));
      });
      geometry[v].normal = normals.normal().cast<float>();
    }
  });
  return geometry;
}

Vec3f face_normal(const TriangleMesh& mesh, std::uint32_t f) { return area_vector(mesh, f).normalized().cast<float>(); }

}  // namespace curvecast
