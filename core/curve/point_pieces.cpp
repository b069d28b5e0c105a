#include "core/curve/point_pieces.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace curvecast {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();

/// 10 bits of each coordinate, interleaved.
std::uint32_t morton_code(const Vec3f& unit) {
  std::uint32_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cell = static_cast<std::uint32_t>(std::clamp(unit[axis], 0.0f, 1.0f) * 1023.0f);
    for (int bit = 0; bit < 10; ++bit) code |= (cell >> bit & 1) << (3 * bit + axis);
  }
  return code;
}

Vec3f point_at(const PointView& points, std::size_t i) {
  return {points.x[i * points.stride], points.y[i * points.stride], points.z[i * points.stride]};
}

}  // namespace

PointView view_of(std::span<const float> x, std::span<const float> y, std::span<const float> z) {
  return {x.data(), y.data(), z.data(), x.size(), 1};
}

PointView view_of(std::span<const Vec3f> points) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  if (points.empty()) return {};
  const float* first = points.front().data();
  return {first, first + 1, first + 2, points.size(), 3};
}

void order_in_space(const PointView& points, std::vector<PointPiece>& pieces) {
  std::vector<Vec3f> place;
  Vec3f min = Vec3f::Constant(kLargest), max = Vec3f::Constant(-kLargest);
  for (const PointPiece& piece : pieces) {
    const Vec3f& p = place.emplace_back(point_at(points, piece.begin + piece.size / 2));
    if (!p.allFinite()) continue;
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  const float extent = (max - min).maxCoeff();
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order;
  for (std::uint32_t i = 0; i < pieces.size(); ++i) {
    const bool placed = place[i].allFinite() && extent > 0 && extent < kLargest;
    order.emplace_back(placed ? morton_code((place[i] - min) / extent) : 0, i);
  }
  std::sort(order.begin(), order.end());
  std::vector<PointPiece> sorted;
  sorted.reserve(pieces.size());
  for (const auto& [code, i] : order) sorted.push_back(pieces[i]);
  pieces = std::move(sorted);
}

}  // namespace curvecast
