#include "core/mesh/principal_directions.h"

#include <array>
#include <cmath>

#include "core/base/for_all.h"

namespace curvecast {
namespace {

constexpr std::size_t kGrain = 4096;  // vertices

/// xx, yy, zz, xy, yz, zx of a symmetric tensor.
using Tensor = std::array<double, 6>;

/// The symmetric part of the derivative of the normal over face f, times its area (and a constant).
Tensor face_tensor(const TriangleMesh& mesh, std::span<const VertexGeometry> geometry, const Triangle& t) {
  const Vec3d side[3] = {mesh.positions[t[2]] - mesh.positions[t[1]], mesh.positions[t[0]] - mesh.positions[t[2]],
                         mesh.positions[t[1]] - mesh.positions[t[0]]};
  const Vec3d cross = side[1].cross(side[2]);
  const Vec3d up = cross / std::sqrt(cross.squaredNorm());
  Tensor sum{};
  for (int i = 0; i < 3; ++i) {
    // The gradient of corner i's weight, times twice the area.
    const Vec3d gradient = up.cross(side[i]);
    const Vec3d n = geometry[t[i]].normal.cast<double>();
    sum[0] += n.x() * gradient.x();
    sum[1] += n.y() * gradient.y();
    sum[2] += n.z() * gradient.z();
    sum[3] += 0.5 * (n.x() * gradient.y() + n.y() * gradient.x());
    sum[4] += 0.5 * (n.y() * gradient.z() + n.z() * gradient.y());
    sum[5] += 0.5 * (n.z() * gradient.x() + n.x() * gradient.z());
  }
  return sum;
}

double apply(const Tensor& t, const Vec3d& u, const Vec3d& v) {
  return t[0] * u.x() * v.x() + t[1] * u.y() * v.y() + t[2] * u.z() * v.z() + t[3] * (u.x() * v.y() + u.y() * v.x()) +
         t[4] * (u.y() * v.z() + u.z() * v.y()) + t[5] * (u.z() * v.x() + u.x() * v.z());
}

}  // namespace

void principal_directions(const TriangleMesh& mesh, const VertexFans& fans, const ExecutionContext& context,
                          std::span<VertexGeometry> geometry) {
  for_blocks(context, geometry.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      Tensor tensor{};
      fans.visit(v, [&](std::uint32_t h) {
        const Tensor of_face = face_tensor(mesh, geometry, mesh.triangles[h / 3]);
        for (std::size_t i = 0; i < tensor.size(); ++i) tensor[i] += of_face[i];
      });
      const Vec3d normal = geometry[v].normal.cast<double>();
      const Vec3d first = normal.unitOrthogonal(), second = normal.cross(first);
      const double difference = apply(tensor, first, first) - apply(tensor, second, second);
      const double angle = 0.5 * std::atan2(2 * apply(tensor, first, second), difference);
      geometry[v].direction_max = (std::cos(angle) * first + std::sin(angle) * second).cast<float>();
    }
  });
}

}  // namespace curvecast
