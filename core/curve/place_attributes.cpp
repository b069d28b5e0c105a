#include "core/curve/place_attributes.h"

#include "core/curve/tangent_frame.h"

namespace curvecast {
namespace {

std::array<float, 3> all_weights(const std::array<float, 2>& weights) {
  return {1 - weights[0] - weights[1], weights[0], weights[1]};
}

}  // namespace

Vec3f normal_at(const SurfaceData& data, std::uint32_t face, const std::array<float, 2>& weights) {
  const std::array<float, 3> w = all_weights(weights);
  const CreaseFace* const crease = data.crease_of(face);
  Vec3f sum = Vec3f::Zero();
  for (std::size_t i = 0; i < 3; ++i) sum += w[i] * data.corner_normal(face, i, crease);
  return sum.stableNormalized();
}

std::array<float, 2> curvatures_at(const SurfaceData& data, std::uint32_t face, const std::array<float, 2>& weights) {
  const std::array<float, 3> w = all_weights(weights);
  const Triangle& corners = data.mesh.triangles[face];
  std::array<float, 2> mean = {};
  for (std::size_t i = 0; i < 3; ++i) {
    const VertexGeometry& corner = data.geometry[corners[i]];
    mean[0] += w[i] * corner.curvature_min;
    mean[1] += w[i] * corner.curvature_max;
  }
  return mean;
}

Vec3f direction_min_at(const SurfaceData& data, std::uint32_t face, const std::array<float, 2>& weights, const Vec3f& normal) {
  constexpr std::uint16_t kQuarterTurn = 1 << 15;  // in codes of axes
  const std::array<float, 3> w = all_weights(weights);
  const Triangle& corners = data.mesh.triangles[face];
  AxisTensor mean = {};
  for (std::size_t i = 0; i < 3; ++i) {
    const AxisTensor axis = axis_tensor(data.geometry[corners[i]].direction_max);
    for (std::size_t k = 0; k < mean.size(); ++k) mean[k] += w[i] * axis[k];
  }
  const std::uint16_t most = pack_axes(mean, normal.x(), normal.y(), normal.z());
  return unpack_direction(static_cast<std::uint16_t>(most + kQuarterTurn), normal);
}

float scalar_at(const SurfaceData& data, std::size_t s, std::uint32_t face, const std::array<float, 2>& weights) {
  const std::array<float, 3> w = all_weights(weights);
  const Triangle& corners = data.mesh.triangles[face];
  const std::span<const float> values = data.scalars[s];
  return w[0] * values[corners[0]] + w[1] * values[corners[1]] + w[2] * values[corners[2]];
}

}  // namespace curvecast
