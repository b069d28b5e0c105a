// SPDX-License-Identifier: Apache-2.0
#include "proto/formats/prefix_distance.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <nanoflann.hpp>

namespace curvecast::formats {
namespace {

/// The points of the prefix, as nanoflann asks for them.
struct Prefix {
  std::vector<std::array<float, 3>> positions;

  // NOLINTBEGIN(readability-identifier-naming): the library's names
  std::size_t kdtree_get_point_count() const { return positions.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return positions[i][axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
  // NOLINTEND(readability-identifier-naming)
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Prefix, double>, Prefix, 3, std::uint32_t>;

}  // namespace

std::vector<float> distances_to_prefix(std::span<const std::array<float, 3>> positions, std::span<const std::uint32_t> ranks,
                                       std::uint64_t prefix) {
  Prefix points;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (ranks[i] < prefix) points.positions.push_back(positions[i]);
  }
  const Tree tree(3, points);
  std::vector<float> distances(positions.size(), 0);
  tbb::parallel_for(std::size_t{0}, positions.size(), [&](std::size_t i) {
    if (ranks[i] < prefix) return;
    std::uint32_t index = 0;
    double squared = 0;
    tree.knnSearch(positions[i].data(), 1, &index, &squared);
    // Up, so that the bound holds.
    distances[i] = std::nextafter(static_cast<float>(std::sqrt(squared)), INFINITY);
  });
  return distances;
}

}  // namespace curvecast::formats
