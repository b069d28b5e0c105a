#include "core/measure/random_surface_points.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"

namespace curvecast {

Vec3d place_in_face(const TriangleMesh& mesh, std::uint32_t face, double first, double second) {
  const double root = std::sqrt(first);
  const Triangle& t = mesh.triangles[face];
  return (1 - root) * mesh.positions[t[0]] + root * (1 - second) * mesh.positions[t[1]] + root * second * mesh.positions[t[2]];
}

SurfacePoints random_surface_points(const TriangleMesh& mesh, std::size_t n, std::uint64_t seed) {
  std::vector<double> area_up_to(mesh.face_count());
  double total = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) area_up_to[f] = total += triangle_area(mesh, f);
  SurfacePoints points{std::vector<Vec3d>(n), std::vector<std::uint32_t>(n)};
  for (std::size_t i = 0; i < n; ++i) {
    // The first face that the area reaches beyond: one with an area of its own, as the total is not reached.
    const double where = std::min(random_unit(seed, 3 * i) * total, std::nextafter(total, 0.0));
    const auto found = std::upper_bound(area_up_to.begin(), area_up_to.end(), where);
    points.faces[i] = static_cast<std::uint32_t>(found - area_up_to.begin());
    points.positions[i] = place_in_face(mesh, points.faces[i], random_unit(seed, 3 * i + 1), random_unit(seed, 3 * i + 2));
  }
  return points;
}

}  // namespace curvecast
