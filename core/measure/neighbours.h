// Nearest neighbours in space, among points of any origin. Source: Bentley, "Multidimensional binary search trees used for
// associative searching" (1975), as nanoflann has it.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/base/execution_context.h"
#include "core/base/vec.h"

namespace curvecast {

/// A point and the square of its distance, rounded as floats are at each step.
struct Neighbour {
  static constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t index = kNobody;
  float square = std::numeric_limits<float>::infinity();

  friend bool operator==(const Neighbour&, const Neighbour&) = default;
};

/// Answers are exact and the same every time: among equal distances the smaller index comes first. Points and queries are finite,
/// and squares of distances do not overflow (coordinates below 1e18). Immutable once built: any number of threads may ask. Copies
/// share the tree.
class NeighbourTree {
 public:
  /// At most 2^32 - 1 points, in any order.
  explicit NeighbourTree(std::vector<Vec3f> points) : NeighbourTree(std::move(points), nullptr) {}
  /// Does the same, or returns Cancelled, at once when the context is cancelled meanwhile.
  static absl::StatusOr<NeighbourTree> build(std::vector<Vec3f> points, const ExecutionContext& context);

  std::span<const Vec3f> points() const;

  /// Finds the found.size() points nearest to the query, nearest first. Returns how many there are, as many as there are points
  /// at most. The rest of `found` becomes nobody. Meant for up to a hundred or so.
  std::size_t nearest(const Vec3f& query, std::span<Neighbour> found) const;

  /// Finds the found.size() others nearest to point i, as nearest() does. Others at the same place count.
  std::size_t nearest_others(std::uint32_t i, std::span<Neighbour> found) const;

  /// Finds all points whose squared distance from the query is at most `square`, by index; where there are more than `most`, more
  /// than `most` of them in any order.
  void within(const Vec3f& query, float square, std::vector<Neighbour>& found,
              std::size_t most = std::numeric_limits<std::size_t>::max()) const;

  /// Finds for every point i the k others nearest to it, nearest first: found[i k] .. found[i k + k - 1], nobody where there are
  /// fewer. `found` has k entries for each point. Others at the same place count. Runs on all threads of the arena.
  void all_nearest(std::size_t k, std::span<Neighbour> found) const;

 private:
  struct Tree;
  NeighbourTree(std::vector<Vec3f> points, const std::atomic<bool>* cancel);

  std::shared_ptr<const Tree> tree_;
};

}  // namespace curvecast
