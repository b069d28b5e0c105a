#include "core/measure/neighbour_lists.h"

#include <absl/strings/str_cat.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <span>

#include "core/base/for_all.h"

namespace curvecast {
namespace {

constexpr std::size_t kBlock = 16;   // points of which one thread makes the lists
constexpr std::size_t kBlocks = 64;  // made before their lists are handed over

/// Has append(i, lists) append the list of every point i, many blocks at once, and hands the blocks over in order. append()
/// returns false where there is no room for more.
template <typename Append>
absl::Status list_all(std::size_t points, const ExecutionContext& context, const TakeNeighbourLists& take, const Append& append) {
  std::array<NeighbourLists, kBlocks> blocks;
  std::atomic<bool> is_full = false;
  for (std::size_t first = 0; first < points; first += kBlock * kBlocks) {
    const std::size_t count = std::min(kBlock * kBlocks, points - first);
    for_blocks(context, count, kBlock, [&](std::size_t begin, std::size_t end) {
      NeighbourLists& lists = blocks[begin / kBlock];
      lists.lengths.clear();
      lists.neighbours.clear();
      for (std::size_t i = begin; i < end && !is_full && !context.cancelled(); ++i) {
        const std::size_t before = lists.neighbours.size();
        if (!append(static_cast<std::uint32_t>(first + i), lists.neighbours)) is_full = true;
        lists.lengths.push_back(static_cast<std::uint32_t>(lists.neighbours.size() - before));
      }
    });
    if (absl::Status status = context.check(); !status.ok()) return status;
    if (is_full) return absl::OutOfRangeError("");
    for (std::size_t b = 0; b * kBlock < count; ++b) {
      if (!take(blocks[b])) return absl::CancelledError("no more lists are wanted");
    }
    context.progress("neighbours", static_cast<double>(first + count) / static_cast<double>(points));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status list_nearest(const NeighbourTree& tree, std::size_t count, const ExecutionContext& context,
                          const TakeNeighbourLists& take) {
  const std::size_t points = tree.points().size();
  const std::size_t length = points == 0 ? 0 : std::min(count, points - 1);
  return list_all(points, context, take, [&](std::uint32_t i, std::vector<Neighbour>& lists) {
    lists.resize(lists.size() + length);
    tree.nearest_others(i, std::span(lists).last(length));
    return true;
  });
}

absl::Status list_within(const NeighbourTree& tree, float square, std::uint64_t most, const ExecutionContext& context,
                         const TakeNeighbourLists& take) {
  // No list need be longer than this to know that all together are too long. What lies within a distance of a point lies in 64
  // cubes of half of that as their sides; in one of them is a 64th of it, or more, and all of that are neighbours of one another.
  const auto longest = static_cast<std::size_t>(64 * (std::sqrt(static_cast<double>(most)) + 2));
  std::atomic<std::uint64_t> total = 0;
  tbb::enumerable_thread_specific<std::vector<Neighbour>> memory;
  absl::Status status = list_all(tree.points().size(), context, take, [&](std::uint32_t i, std::vector<Neighbour>& lists) {
    std::vector<Neighbour>& found = memory.local();
    tree.within(tree.points()[i], square, found, longest);
    std::erase_if(found, [i](const Neighbour& neighbour) { return neighbour.index == i; });
    lists.insert(lists.end(), found.begin(), found.end());
    return found.size() < longest && (total += found.size()) <= most;
  });
  if (!absl::IsOutOfRange(status)) return status;
  return absl::OutOfRangeError(
      absl::StrCat("there are more than ", most, " neighbours within that distance, of all points together"));
}

}  // namespace curvecast
