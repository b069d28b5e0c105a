// Nearest neighbours and points within a radius, in space, among points (curve vertices, samples). Space is what counts, so
// queries cross the cuts of a curve's discs by themselves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/measure/point_tree.h"
#include "core/measure/point_view.h"

namespace curvecast {

/// A point and the square of its distance, rounded as floats are at each step.
struct Neighbour {
  static constexpr std::uint32_t kNobody = PointTree::kNobody;

  std::uint32_t index = kNobody;
  float square = std::numeric_limits<float>::infinity();

  friend bool operator==(const Neighbour&, const Neighbour&) = default;
};

/// Answers are exact and the same every time: among equal distances the smaller index comes first. Distances are taken between
/// floats whose squares must not overflow (coordinates below 1e18). Points that are not finite are never found, and a query that
/// is not finite finds nothing. Immutable once built: any number of threads may ask.
class NeighbourTree {
 public:
  NeighbourTree() = default;
  /// Copies the points, at most 2^32 - 1, in any order. Built by all threads of the arena.
  explicit NeighbourTree(const PointView& points) : tree_(points) {}

  std::size_t size() const { return tree_.size; }

  /// The found.size() points nearest to the query, nearest first; returns how many there are, size() at most. The rest of `found`
  /// becomes nobody. Meant for up to a hundred or so.
  std::size_t nearest(const Vec3f& query, std::span<Neighbour> found) const;

  /// Replaces `found` by every point whose squared distance is at most radius^2 (as a float), in no particular order.
  void within(const Vec3f& query, float radius, std::vector<Neighbour>& found) const;

  /// For every point i the k others nearest to it, nearest first: found[i k] .. found[i k + k - 1], nobody where there are fewer.
  /// `found` has size() * k entries. Others at the same place count. Runs on all threads of the arena.
  void all_nearest(std::size_t k, std::span<Neighbour> found) const;

  /// Bytes held.
  std::size_t byte_size() const { return tree_.byte_size(); }

 private:
  PointTree tree_;
};

}  // namespace curvecast
