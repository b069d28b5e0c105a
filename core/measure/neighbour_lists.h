// The neighbours of all points of a set, one point's list after the other's.
#pragma once

#include <absl/status/status.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/base/execution_context.h"
#include "core/measure/neighbours.h"

namespace curvecast {

/// Lists of points that follow one another.
struct NeighbourLists {
  std::vector<std::uint32_t> lengths;  // of each point's list
  std::vector<Neighbour> neighbours;   // all lists
};

/// Is called with some lists after the other, in the order of the points, until it returns false.
using TakeNeighbourLists = std::function<bool(const NeighbourLists& lists)>;

/// Hands over for every point of the tree the `count` others nearest to it, nearest first; all others where there are fewer. Runs
/// on all threads of the arena; tells its progress as "neighbours". Cancelled, also where `take` returned false.
absl::Status list_nearest(const NeighbourTree& tree, std::size_t count, const ExecutionContext& context,
                          const TakeNeighbourLists& take);

/// Hands over for every point of the tree all others whose squared distance is at most `square`, by index; else as
/// list_nearest(). OutOfRange where all lists together have more than `most` neighbours; the first ones may have been taken by
/// then.
absl::Status list_within(const NeighbourTree& tree, float square, std::uint64_t most, const ExecutionContext& context,
                         const TakeNeighbourLists& take);

}  // namespace curvecast
