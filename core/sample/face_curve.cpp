#include "core/sample/face_curve.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/for_all.h"
#include "core/mesh/centroid.h"
#include "core/mesh/face_order.h"

namespace curvecast {
namespace {

constexpr std::size_t kGrain = 4096;

}  // namespace

FaceWay::FaceWay(const TriangleMesh& mesh, std::uint32_t face, const Vec3d& direction) {
  const Triangle& t = mesh.triangles[face];
  std::size_t from = 0;
  double longest = -1;
  for (std::size_t i = 0; i < 3; ++i) {
    const double length = (mesh.positions[t[i]] - mesh.positions[t[(i + 1) % 3]]).squaredNorm();
    if (length > longest) longest = length, from = i;
  }
  std::size_t to = (from + 1) % 3;
  if (direction.dot(mesh.positions[t[to]] - mesh.positions[t[from]]) < 0) std::swap(from, to);
  const std::array<Vec2d, 3> corners{Vec2d(0, 0), Vec2d(1, 0), Vec2d(0, 1)};
  begin_ = corners[from], apex_ = corners[3 - from - to], end_ = corners[to];
}

std::array<float, 2> FaceWay::at(double part, int halvings) const {
  Vec2d begin = begin_, apex = apex_, end = end_;
  for (int i = 0; i < halvings; ++i) {
    const Vec2d middle = (begin + end) / 2;
    part *= 2;
    const bool is_second = part >= 1;
    part -= is_second ? 1 : 0;
    // The halves meet in the apex: the curve goes from the begin to it, and from there to the end.
    begin = is_second ? apex : begin;
    end = is_second ? end : apex;
    apex = middle;
  }
  const Vec2d place = (begin + apex) / 2 + part / 2 * (end - begin);
  return {static_cast<float>(place.x()), static_cast<float>(place.y())};
}

FaceCurve::FaceCurve(const TriangleMesh& mesh, double largest, const ExecutionContext& context)
    : mesh_(mesh), order_(face_order(mesh, context)), begin_(order_.size() + 1, 0) {
  // As many halves of halves as each face takes.
  const auto halvings = [&](std::uint32_t face) {
    const double wanted = std::isfinite(largest) ? triangle_area(mesh, face) / largest : 0;
    return wanted > 1 ? std::min(static_cast<int>(std::ceil(std::log2(wanted))), kMostHalvings) : 0;
  };
  for_blocks(context, order_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) begin_[i + 1] = 1U << halvings(order_[i]);
  });
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  place_of_.resize(begin_.back());
  for_blocks(context, order_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::fill(place_of_.begin() + begin_[i], place_of_.begin() + begin_[i + 1], static_cast<std::uint32_t>(i));
    }
  });
}

double FaceCurve::area(std::size_t piece) const {
  const std::size_t place = place_of_[piece];
  return triangle_area(mesh_, order_[place]) / static_cast<double>(begin_[place + 1] - begin_[place]);
}

FaceCurve::Way FaceCurve::way(std::size_t piece) const {
  const std::size_t place = place_of_[piece];
  const std::uint32_t before = order_[place > 0 ? place - 1 : 0], after = order_[std::min(place + 1, order_.size() - 1)];
  const double share = 1 / static_cast<double>(begin_[place + 1] - begin_[place]);
  return {.way = FaceWay(mesh_, order_[place], centroid(mesh_, after) - centroid(mesh_, before)),
          .begin = static_cast<double>(piece - begin_[place]) * share,
          .share = share,
          .halvings = std::countr_zero(begin_[place + 1] - begin_[place])};
}

}  // namespace curvecast
