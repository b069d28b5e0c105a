// Nearest neighbours in space, among points of any origin. Source: Bentley, "Multidimensional binary search trees used for
// associative searching" (1975), as nanoflann has it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

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
  explicit NeighbourTree(std::vector<Vec3f> points);

  std::span<const Vec3f> points() const;

  /// Finds the found.size() points nearest to the query, nearest first. Returns how many there are, as many as there are points
  /// at most. The rest of `found` becomes nobody. Meant for up to a hundred or so.
  std::size_t nearest(const Vec3f& query, std::span<Neighbour> found) const;

  /// Finds all points whose squared distance from the query is at most `square`, by index.
  void within(const Vec3f& query, float square, std::vector<Neighbour>& found) const;

  /// Finds for every point i the k others nearest to it, nearest first: found[i k] .. found[i k + k - 1], nobody where there are
  /// fewer. `found` has k entries for each point. Others at the same place count. Runs on all threads of the arena.
  void all_nearest(std::size_t k, std::span<Neighbour> found) const;

 private:
  struct Tree;
  std::shared_ptr<const Tree> tree_;
};

}  // namespace curvecast
