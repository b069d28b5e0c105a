// How many points of a set along the curve lie before given places, without sorting the set.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace curvecast {

/// Keeps its memory from call to call; for one thread at a time.
class PlaceCounts {
 public:
  /// below[i] = how many of `places` are less than queries[i]; both in any order. below.size() = queries.size().
  void count_below(std::span<const std::uint32_t> places, std::span<const std::uint32_t> queries, std::span<std::uint32_t> below);

  /// Held, whether in use or not.
  std::size_t byte_size() const;

 private:
  // Of each bucket of places: how many there are in those before, whether a query falls into it, and where its members end.
  std::vector<std::uint32_t> first_, end_;
  std::vector<std::uint8_t> wanted_;
  std::vector<std::uint32_t> members_;  // of the wanted buckets, one after the other
};

}  // namespace curvecast
