#include "core/codec/delta_symbols.h"

#include <algorithm>

#include "core/base/simd.h"

namespace curvecast {
namespace {

struct Wrap {
  std::int32_t length, least, most;  // of the range; of the differences
};

Wrap wrap_of(const ValueRange& range) {
  const std::int32_t length = range.most - range.least + 1;
  return {.length = length, .least = -(length / 2), .most = (length - 1) / 2};
}

[[gnu::always_inline]] inline std::uint32_t symbol_of(std::int32_t difference, const Wrap& wrap) {
  difference += difference < wrap.least ? wrap.length : 0;
  difference -= difference > wrap.most ? wrap.length : 0;
  return (static_cast<std::uint32_t>(difference) << 1) ^ static_cast<std::uint32_t>(difference >> 31);
}

CURVECAST_WIDE void symbols_after(const std::int32_t* __restrict values, const std::int32_t* __restrict before, std::size_t n,
                                  const Wrap& wrap_in, std::uint32_t* __restrict symbols) {
  const Wrap wrap = wrap_in;
  for (std::size_t i = 0; i < n; ++i) symbols[i] = symbol_of(values[i] - before[i], wrap);
}

CURVECAST_WIDE void widen(const std::int32_t* values, std::size_t n, ValueRange& range) {
  std::int32_t least = range.least, most = range.most;
  for (std::size_t i = 0; i < n; ++i) {
    least = values[i] < least ? values[i] : least;
    most = values[i] > most ? values[i] : most;
  }
  range = {least, most};
}

}  // namespace

ValueRange range_of(std::span<const std::int32_t> values) {
  ValueRange range{values[0], values[0]};
  widen(values.data(), values.size(), range);
  return range;
}

void delta_symbols(std::span<const std::int32_t> values, int components, const ValueRange& range,
                   std::span<std::uint32_t> symbols) {
  const Wrap wrap = wrap_of(range);
  const std::size_t first = static_cast<std::size_t>(components);
  const std::int32_t before = std::clamp(0, range.least, range.most);
  for (std::size_t i = 0; i < first; ++i) symbols[i] = symbol_of(values[i] - before, wrap);
  symbols_after(values.data() + first, values.data(), values.size() - first, wrap, symbols.data() + first);
}

}  // namespace curvecast
