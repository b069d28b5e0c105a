// Lists of the nearest points found so far: one, a few in registers, many in memory. Each takes offers in any order and says the
// distance beyond which it wants none.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "core/measure/neighbours.h"

namespace curvecast {

/// The squared distance beyond which a list that is not full wants nothing.
inline constexpr float kFarthest = std::numeric_limits<float>::max();

/// Larger for what is farther, or as far with a larger index.
inline std::uint64_t order_of(const Neighbour& n) {
  return static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(n.square)) << 32 | n.index;
}
inline Neighbour neighbour_of(std::uint64_t order) {
  return {static_cast<std::uint32_t>(order), std::bit_cast<float>(static_cast<std::uint32_t>(order >> 32))};
}
inline float limit_of(const Neighbour& last) { return last.square < kFarthest ? last.square : kFarthest; }

/// A single one.
class NearestOne {
 public:
  float limit() const { return limit_of(neighbour_of(order_)); }
  void offer(const Neighbour& n) {
    const std::uint64_t order = order_of(n);
    order_ = order < order_ ? order : order_;
  }
  void write(std::span<Neighbour> found) const { found[0] = neighbour_of(order_); }

 private:
  std::uint64_t order_ = order_of(Neighbour{});
};

/// Up to `capacity`, an even number, sorted in registers: an offer moves what is farther by one place, without a jump. The orders
/// are read as doubles, which compare alike as none of them is negative or not a number.
template <std::size_t capacity>
class NearestFew {
 public:
  /// The list has zeros before its k entries, which nothing displaces.
  explicit NearestFew(std::size_t k) {
    for (std::size_t i = 0; i < capacity; ++i) {
      pairs_[i / 2][i % 2] = i < capacity - k ? 0.0 : std::bit_cast<double>(order_of(Neighbour{}));
    }
  }
  float limit() const { return limit_of(entry(capacity - 1)); }
  void offer(const Neighbour& n) {
    const double order = std::bit_cast<double>(order_of(n));
    const Pair both = {order, order};
    Pair before = {0.0, pairs_[0][0]};
    for (std::size_t i = 0; i < capacity / 2; ++i) {
      const Pair old = pairs_[i];
      const Pair nearer = old < both ? old : both;
      pairs_[i] = before > nearer ? before : nearer;
      if (i + 1 < capacity / 2) before = Pair{old[1], pairs_[i + 1][0]};
    }
  }
  void write(std::span<Neighbour> found) const {
    for (std::size_t i = 0; i < found.size(); ++i) found[i] = entry(capacity - found.size() + i);
  }

 private:
  using Pair = double __attribute__((vector_size(16)));

  Neighbour entry(std::size_t i) const { return neighbour_of(std::bit_cast<std::uint64_t>(pairs_[i / 2][i % 2])); }

  Pair pairs_[capacity / 2];
};

/// Any number, where they are wanted; the last falls out when a nearer one comes.
class NearestMany {
 public:
  NearestMany() = default;
  /// `found` holds nobody.
  explicit NearestMany(std::span<Neighbour> found) : found_(found) {}

  float limit() const { return limit_of(found_.back()); }
  void offer(const Neighbour& n) {
    const std::uint64_t order = order_of(n);
    std::size_t i = found_.size() - 1;
    if (order >= order_of(found_[i])) return;
    for (; i > 0 && order_of(found_[i - 1]) > order; --i) found_[i] = found_[i - 1];
    found_[i] = n;
  }
  void write(std::span<Neighbour>) const {}  // they are there already

 private:
  std::span<Neighbour> found_;
};

}  // namespace curvecast
