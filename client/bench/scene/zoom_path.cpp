#include "client/bench/scene/zoom_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/random.h"

namespace curvecast::cli::bench {
namespace {

constexpr double kTilt = 0.15;          // radians between the line of sight and the normal
constexpr double kSurroundings = 0.02;  // of the diagonal: faces so near say where the surface faces

Vec3d corner(const TriangleMesh& mesh, std::size_t f, int c) {
  return mesh.positions[mesh.triangles[f][static_cast<std::size_t>(c)]];
}
Vec3d middle(const TriangleMesh& mesh, std::size_t f) {
  return (corner(mesh, f, 0) + corner(mesh, f, 1) + corner(mesh, f, 2)) / 3;
}
/// Twice the area long.
Vec3d area_vector(const TriangleMesh& mesh, std::size_t f) {
  return (corner(mesh, f, 1) - corner(mesh, f, 0)).cross(corner(mesh, f, 2) - corner(mesh, f, 0));
}

Vec3d normal_around(const TriangleMesh& mesh, std::size_t face) {
  const Vec3d centre = middle(mesh, face), own = area_vector(mesh, face);
  const double reach = kSurroundings * bounding_box(mesh).diagonal();
  Vec3d sum = own;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const Vec3d area = area_vector(mesh, f);
    if ((middle(mesh, f) - centre).norm() < reach && area.dot(own) > 0) sum += area;
  }
  return sum.normalized();
}

}  // namespace

SurfacePlace front_of(const TriangleMesh& mesh) {
  const Vec3d front = Vec3d(0.3, 0.2, 1).normalized();
  std::size_t best = 0;
  for (std::size_t f = 1; f < mesh.face_count(); ++f) {
    if (middle(mesh, f).dot(front) > middle(mesh, best).dot(front)) best = f;
  }
  return {middle(mesh, best), normal_around(mesh, best)};
}

SurfacePlace random_place(const TriangleMesh& mesh, std::uint64_t seed) {
  std::vector<double> until(mesh.face_count());
  double sum = 0;
  for (std::size_t f = 0; f < until.size(); ++f) until[f] = sum += area_vector(mesh, f).norm();
  const auto found = std::ranges::upper_bound(until, sum * random_unit(seed, 0));
  const auto face = static_cast<std::size_t>(std::min<std::ptrdiff_t>(found - until.begin(), std::ssize(until) - 1));
  // Anywhere in the face: what folds over is turned back.
  double u = random_unit(seed, 1), v = random_unit(seed, 2);
  if (u + v > 1) u = 1 - u, v = 1 - v;
  const Vec3d a = corner(mesh, face, 0);
  return {a + u * (corner(mesh, face, 1) - a) + v * (corner(mesh, face, 2) - a), normal_around(mesh, face)};
}

v1::Camera camera_above(const SurfacePlace& place, double distance, double degrees) {
  const Vec3d across = (std::abs(place.normal.y()) < 0.9 ? Vec3d::UnitY() : Vec3d::UnitX()).cross(place.normal).normalized();
  const Vec3d up = place.normal.cross(across);
  const double angle = degrees * std::numbers::pi / 180;
  const Vec3d sight = std::cos(kTilt) * place.normal + std::sin(kTilt) * (std::cos(angle) * across + std::sin(angle) * up);
  v1::Camera camera;
  const auto set = [](v1::Vec3& to, const Vec3d& v) { to.set_x(v.x()), to.set_y(v.y()), to.set_z(v.z()); };
  set(*camera.mutable_eye(), place.position + distance * sight);
  set(*camera.mutable_target(), place.position);
  set(*camera.mutable_up(), up);
  return camera;
}

}  // namespace curvecast::cli::bench
