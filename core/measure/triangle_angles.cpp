#include "core/measure/triangle_angles.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace curvecast {
namespace {

double least_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const auto angle = [](const Vec3d& p, const Vec3d& q) { return std::atan2(p.cross(q).norm(), p.dot(q)); };
  return std::min({angle(b - a, c - a), angle(c - b, a - b), angle(a - c, b - c)}) * 180 / std::numbers::pi;
}

}  // namespace

LeastAngles least_angles(const MeshView& mesh) {
  if (mesh.triangles.empty()) return {};
  std::vector<double> angles;
  angles.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    angles.push_back(least_angle(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]));
  }
  std::sort(angles.begin(), angles.end());
  const auto below = std::lower_bound(angles.begin(), angles.end(), 20.0) - angles.begin();
  return {angles[angles.size() / 2], angles[angles.size() / 100], angles[0],
          static_cast<double>(below) / static_cast<double>(angles.size())};
}

}  // namespace curvecast
