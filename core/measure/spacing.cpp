#include "core/measure/spacing.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/packed_distance.h"

namespace curvecast {
namespace {

constexpr float kLeastCosine = -0.5f;

/// Of each point's neighbour, where there is one.
NeighbourDistances summarise(std::span<const Neighbour> nearest, const PointCloud& points, double area) {
  const double unit = 2 * packing_radius(area, points.size());
  NeighbourDistances distances{std::numeric_limits<double>::infinity(), 0, 0};
  std::size_t count = 0;
  for (const Neighbour& neighbour : nearest) {
    if (neighbour.index == Neighbour::kNobody) continue;
    const double distance = points.distance(neighbour) / unit;
    distances.min = std::min(distances.min, distance);
    distances.max = std::max(distances.max, distance);
    distances.mean += distance;
    ++count;
  }
  if (count == 0) return {};
  distances.mean /= static_cast<double>(count);
  return distances;
}

}  // namespace

double packing_radius(double area, std::size_t n) { return 0.5 * packed_distance(area, static_cast<double>(n)); }

NeighbourDistances neighbour_distances(double area, const PointCloud& points) {
  std::vector<Neighbour> nearest(points.size());
  points.tree.all_nearest(1, nearest);
  return summarise(nearest, points, area);
}

NeighbourDistances neighbour_distances_on_side(double area, const PointCloud& points, std::span<const Vec3f> normals) {
  constexpr std::size_t kFew = 4, kMany = 65;  // the point itself among the many
  std::vector<Neighbour> few(kFew * points.size());
  points.tree.all_nearest(kFew, few);
  std::vector<Neighbour> nearest(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    const Vec3f& normal = normals[i];
    const auto on_side = [&](const Neighbour& n) {
      return n.index != Neighbour::kNobody && n.index != i && normal.dot(normals[n.index]) >= kLeastCosine;
    };
    const auto* const begin = few.data() + kFew * i;
    const auto* const found = std::find_if(begin, begin + kFew, on_side);
    if (found != begin + kFew) {
      nearest[i] = *found;
      return;
    }
    std::array<Neighbour, kMany> many;
    points.tree.nearest(points.tree.points()[i], many);
    const auto* const farther = std::find_if(many.begin(), many.end(), on_side);
    if (farther != many.end()) nearest[i] = *farther;
  });
  return summarise(nearest, points, area);
}

}  // namespace curvecast
