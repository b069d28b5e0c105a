// A tree of boxes over points in space: they are halved along the widest axis of their box, again and again, until few are left.
// (Runs of a Hilbert curve on a surface would do without this, but their boxes overlap: a query opens three times as many.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/column.h"
#include "core/measure/point_view.h"

namespace curvecast {

/// Immutable once built: any number of threads may read.
struct PointTree {
  static constexpr std::size_t kLeafSize = 16;
  static constexpr std::size_t kFanOut = 8;
  static constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();

  struct alignas(64) Leaf {
    float p[3][kLeafSize];           // coordinates; infinite behind the last point, and for points that are not finite
    std::uint32_t index[kLeafSize];  // of the points; nobody behind the last
  };
  struct alignas(64) Boxes {
    float min[3][kFanOut], max[3][kFanOut];  // of finite points; min > max where there are none
  };

  PointTree() = default;
  /// At most 2^32 - 1 points, in any order. Built by all threads of the arena; the same for any number of them.
  explicit PointTree(const PointView& points);

  /// Bytes held.
  std::size_t byte_size() const { return leaves.size() * sizeof(Leaf) + boxes.size() * sizeof(Boxes); }

  std::size_t size = 0;  // of points
  Column<Leaf> leaves;
  Column<Boxes> boxes;                     // of eight leaves each, then of eight of those, and so on up to the root
  std::vector<std::uint32_t> level_begin;  // offsets into boxes, and their number
};

}  // namespace curvecast
