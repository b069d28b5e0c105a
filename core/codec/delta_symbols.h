// Differences between neighbours as small unsigned numbers, as Draco's "difference" prediction with the "wrap" transform has
// them: a difference of more than half of the values' range goes around it the other way; 0, -1, 1, -2, ... are 0, 1, 2, 3, ...
#pragma once

#include <cstdint>
#include <span>

namespace curvecast {

struct ValueRange {
  std::int32_t least, most;
};

/// Precondition: there are values.
ValueRange range_of(std::span<const std::int32_t> values);

/// Symbols of values -2^30 .. 2^30 of which no two differ by 2^31 or more, `components` for a point; the first point's
/// predecessor has all components at 0, or where the range comes nearest to it. `symbols` has room for as many as there are
/// values and does not overlap them; `range` is that of the values.
void delta_symbols(std::span<const std::int32_t> values, int components, const ValueRange& range,
                   std::span<std::uint32_t> symbols);

}  // namespace curvecast
