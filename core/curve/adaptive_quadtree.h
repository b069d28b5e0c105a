// The adaptive Hilbert curve: leaves of a quadtree over the parameter square, in curve order (paper, section 3.2; Quinn,
// Langbein, Martin, Elber, "Density-controlled sampling of parametric surfaces using adaptive space-filling curves", 2006).
#pragma once

#include <absl/status/statusor.h>

#include <bit>
#include <cstdint>
#include <functional>
#include <span>

#include "core/base/column.h"
#include "core/base/execution_context.h"
#include "core/base/vec.h"
#include "core/curve/hilbert.h"
#include "core/curve/parameter_triangle.h"

namespace curvecast {

/// A leaf's square in [0, 1]^2.
struct Quad {
  Vec2d corner;  // lower left
  double side;
};
Quad leaf_quad(std::uint64_t key, std::uint8_t level);

/// Side of the squares of a level, 0 <= level <= kMaxLevel: a power of two.
[[gnu::always_inline]] inline double side_of_level(int level) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(1023 - level) << 52);
}
inline constexpr double kCellSide = 1.0 / (1u << kMaxLevel);

struct QuadtreeLeaves {
  Column<std::uint64_t> key;             // L, ascending: Hilbert index of the leaf's first cell at kMaxLevel
  Column<std::uint8_t> level;            // L
  Column<std::uint32_t> x, y;            // L: lower left corner of the leaf's square, in cells of kMaxLevel
  Column<std::uint32_t> triangle_begin;  // L + 1 offsets into `triangles`
  Column<std::uint32_t> triangles;       // triangles of the disc that overlap or touch each leaf; at least one

  std::size_t size() const { return key.size(); }
  /// Returns the leaf's square in [0, 1]^2: what leaf_quad() says, at once.
  Quad quad(std::size_t l) const { return {Vec2d(x[l] * kCellSide, y[l] * kCellSide), side_of_level(level[l])}; }
  std::span<const std::uint32_t> triangles_of(std::size_t l) const {
    return {triangles.data() + triangle_begin[l], triangle_begin[l + 1] - triangle_begin[l]};
  }
};

/// Asked, by one thread at a time, for as many leaves as there are about to be, each time for more; an error ends the division.
using LeavesClaim = std::function<absl::Status(std::size_t leaves)>;

/// Divides the square until each leaf, as one curve vertex, is enough for every triangle that it overlaps: a triangle t wants
/// demand[t] curve vertices per unit of uv area. Leaves that meet no triangle are left out. At most `max_leaves` (>= 1024):
/// where more are wanted the highest demands are lowered until they fit. The same leaves for any number of threads.
/// Cancelled when the context says so. ResourceExhausted: the lists of triangles would hold more than 2^32 entries. `claim`, if
/// not empty: its errors.
absl::StatusOr<QuadtreeLeaves> build_quadtree(std::span<const ParameterTriangle> triangles, std::span<const double> demand,
                                              std::size_t max_leaves, const ExecutionContext& context = {},
                                              const LeavesClaim& claim = {});

}  // namespace curvecast
