#include "core/measure/signed_distance.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/for_all.h"
#include "core/mesh/triangle_distance.h"

namespace curvecast {
namespace {

constexpr std::size_t kBlock = 4096;
// A corner that weighs less than this has no part in the place: that lies on the edge across from it.
constexpr double kNoWeight = 1e-9;

Vec3d unit_normal(const TriangleMesh& mesh, std::uint32_t face) { return area_vector(mesh, face).normalized(); }

/// Weights of the corners of the face at a place on it.
std::array<double, 3> weights_at(const TriangleMesh& mesh, std::uint32_t face, const Vec3d& place) {
  const Triangle& t = mesh.triangles[face];
  const Vec3d normal = area_vector(mesh, face);
  std::array<double, 3> weights;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d &b = mesh.positions[t[(i + 1) % 3]], &c = mesh.positions[t[(i + 2) % 3]];
    weights[i] = (b - place).cross(c - place).dot(normal) / normal.squaredNorm();
  }
  return weights;
}

}  // namespace

absl::StatusOr<SignedDistance> SignedDistance::of(const TriangleMesh& mesh) {
  const auto borders = std::count(mesh.twins.begin(), mesh.twins.end(), kNone);
  if (borders > 0) {
    return absl::FailedPreconditionError(
        absl::StrFormat("the mesh is open, with %d edges at borders, and so has no inside: close it first", borders));
  }
  return SignedDistance(mesh);
}

SignedDistance::SignedDistance(const TriangleMesh& mesh)
    : mesh_(&mesh), tree_(mesh), vertex_normals_(mesh.vertex_count(), Vec3d::Zero()) {
  double volume = 0;
  const Vec3d middle = bounding_box(mesh).center();
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const Triangle& t = mesh.triangles[f];
    const Vec3d normal = unit_normal(mesh, f);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3d &a = mesh.positions[t[i]], b = mesh.positions[t[(i + 1) % 3]] - a, c = mesh.positions[t[(i + 2) % 3]] - a;
      vertex_normals_[t[i]] += std::atan2(b.cross(c).norm(), b.dot(c)) * normal;
    }
    volume += (mesh.positions[t[0]] - middle).dot(area_vector(mesh, f));
  }
  outwards_ = volume < 0 ? -1 : 1;
}

double SignedDistance::sign(const Vec3d& point, std::uint32_t face) const {
  const Triangle& t = mesh_->triangles[face];
  const Vec3d place = nearest_on_triangle(point, mesh_->positions[t[0]], mesh_->positions[t[1]], mesh_->positions[t[2]]);
  const std::array<double, 3> weights = weights_at(*mesh_, face, place);
  const auto has = [&](std::size_t i) { return weights[i] > kNoWeight; };
  const auto corners = static_cast<int>(has(0)) + static_cast<int>(has(1)) + static_cast<int>(has(2));
  Vec3d normal = unit_normal(*mesh_, face);
  if (corners == 2) {
    for (std::uint32_t i = 0; i < 3; ++i) {  // the halfedge from corner i faces corner i + 2
      if (!has((i + 2) % 3)) normal += unit_normal(*mesh_, mesh_->twins[3 * face + i] / 3);
    }
  } else if (corners < 2) {
    normal = vertex_normals_[t[static_cast<std::size_t>(std::max_element(weights.begin(), weights.end()) - weights.begin())]];
  }
  return outwards_ * (point - place).dot(normal) < 0 ? -1 : 1;
}

absl::Status SignedDistance::find(std::span<const Vec3d> points, std::span<double> distances,
                                  const ExecutionContext& context) const {
  for_blocks(context, points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const NearestFace nearest = tree_.nearest(points[i]);
      distances[i] = nearest.distance * sign(points[i], nearest.face);
    }
  });
  return context.check();
}

}  // namespace curvecast
