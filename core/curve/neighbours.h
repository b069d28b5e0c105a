// Nearest neighbours and points within a radius, in space, among points in curve order (curve vertices, samples). Points that
// follow one another on a Hilbert curve lie close together, so runs of them are the leaves of a tree of boxes as they are: it is
// built in one pass, without sorting. Boxes lie in space, so queries cross cuts and discs by themselves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/column.h"
#include "core/curve/point_pieces.h"
#include "core/vec.h"

namespace curvecast {

/// A point and the square of its distance, rounded as floats are at each step.
struct Neighbour {
  static constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();

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
  /// Copies the points, at most 2^32 - 1. `piece_begin`: where runs of points begin that may lie far from those before them,
  /// ascending and ending with the number of points (SurfaceCurve::disc_begin); empty for a single run. Any order of points gives
  /// right answers; quick ones want neighbours near one another. Built by all threads of the arena.
  explicit NeighbourTree(const PointView& points, std::span<const std::uint32_t> piece_begin = {});

  std::size_t size() const { return size_; }

  /// The found.size() points nearest to the query, nearest first; returns how many there are, size() at most. The rest of `found`
  /// becomes nobody. Meant for up to a hundred or so.
  std::size_t nearest(const Vec3f& query, std::span<Neighbour> found) const;

  /// Replaces `found` by every point whose squared distance is at most radius^2 (as a float), in no particular order.
  void within(const Vec3f& query, float radius, std::vector<Neighbour>& found) const;

  /// For every point i the k others nearest to it, nearest first: found[i k] .. found[i k + k - 1], nobody where there are fewer.
  /// `found` has size() * k entries. Others at the same place count. Runs on all threads of the arena.
  void all_nearest(std::size_t k, std::span<Neighbour> found) const;

  /// Bytes held.
  std::size_t byte_size() const;

 private:
  friend class NeighbourSearch;
  static constexpr std::size_t kLeafSize = 16;
  static constexpr std::size_t kFanOut = 8;

  struct alignas(64) Leaf {
    float p[3][kLeafSize];  // coordinates; infinite behind the last point
  };
  struct alignas(64) Boxes {
    float min[3][kFanOut], max[3][kFanOut];  // min > max behind the last child
  };

  void fill_leaves(const PointView& points, std::span<const std::uint32_t> piece_begin);
  void stack_boxes();

  std::size_t size_ = 0;
  Column<Leaf> leaves_;
  Column<std::uint32_t> first_;             // of each leaf's points
  Column<std::uint8_t> count_;              // of each leaf's points
  Column<Boxes> boxes_;                     // of eight leaves each, then of eight of those, and so on up to the root
  std::vector<std::uint32_t> level_begin_;  // offsets into boxes_
};

}  // namespace curvecast
