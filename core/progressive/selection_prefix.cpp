#include "core/progressive/selection_prefix.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "core/base/simd.h"
#include "core/progressive/progressive.h"

namespace curvecast {
namespace {

constexpr std::size_t kWord = RankSelection::kWord;
// Where a chunk has so many positions for each point shown, the points are looked up among the positions, not these in the chunk.
constexpr std::size_t kSparse = 8;

/// Finds which of some ascending curve positions lie in the strata of chunks, one chunk after the other in order of id: from
/// where those of the chunk before ended.
class PositionsInChunks {
 public:
  explicit PositionsInChunks(std::span<const std::uint64_t> positions) : positions_(positions) {}

  /// Returns [first, second) of the positions.
  std::pair<std::size_t, std::size_t> next(const ChunkId& id) {
    if (id.level == kChunkLevels) return {0, positions_.size()};
    if (id.level != level_) level_ = id.level, at_ = 0;
    const std::size_t first = at_ = from(id.index);
    at_ = from(id.index + 1);
    return {first, at_};
  }

 private:
  /// Returns the first position from `at_` on that is in a stratum of the chunks' level, or after it.
  std::size_t from(std::uint64_t stratum) const {
    const int bits = 64 - 2 * (level_ - kChunkLevels);
    const auto is_before = [&](std::size_t i) { return positions_[i] >> bits < stratum; };
    std::size_t begin = at_, step = 1;
    for (; begin + step < positions_.size() && is_before(begin + step); step *= 2) begin += step;
    std::size_t end = std::min(begin + step, positions_.size());
    while (begin < end) {
      const std::size_t middle = (begin + end) / 2;
      if (is_before(middle)) {
        begin = middle + 1;
      } else {
        end = middle;
      }
    }
    return begin;
  }

  std::span<const std::uint64_t> positions_;
  int level_ = 0;
  std::size_t at_ = 0;
};

/// Counts the points shown of a layer that come before curve positions, which lie in the chunk's stratum and ascend.
class LayerPrefix {
 public:
  /// `words`: the bits of the layer's points, the first of which is point `first` of the chunk.
  LayerPrefix(const RankChunk& chunk, std::size_t first, const std::uint64_t* words)
      : id_(chunk.id), positions_(&chunk.curve_position[first]), words_(words) {}

  std::uint32_t operator()(std::uint64_t position) {
    const std::size_t stratum = id_.stratum_in_layer(position);
    for (; word_ < stratum / kWord; ++word_) count_ += std::popcount(words_[word_]);
    const std::uint64_t word = words_[word_], bit = std::uint64_t{1} << stratum % kWord;
    // Of a point that is not shown nothing has to be read.
    const bool is_before = (word & bit) != 0 && positions_[stratum] < position;
    return static_cast<std::uint32_t>(count_ + std::popcount(word & (bit - 1)) + (is_before ? 1 : 0));
  }

 private:
  const ChunkId id_;
  const std::uint64_t* const positions_;
  const std::uint64_t* const words_;
  std::size_t word_ = 0;
  int count_ = 0;
};

}  // namespace

CURVECAST_WIDE void count_selected_before(const RankSelection& selection, std::span<const std::uint64_t> curve_positions,
                                          std::span<std::uint32_t> before) {
  std::ranges::fill(before, 0);
  PositionsInChunks ends(curve_positions), ranges(curve_positions);
  const auto is_sparse = [](std::size_t shown, std::size_t positions) { return kSparse * shown < positions; };
  for (std::size_t p = 0; p < selection.parts.size(); ++p) {
    const RankChunk& chunk = *selection.parts[p].chunk;
    const std::size_t shown = selection.count_of(p);
    const std::pair<std::size_t, std::size_t> range = ends.next(chunk.id);
    const std::size_t first = range.first, end = range.second;  // clang 14 captures no structured bindings
    if (is_sparse(shown, end - first)) {
      const auto in_chunk = curve_positions.subspan(first, end - first);
      selection.for_each_shown_of(p, [&](std::size_t point) {
        const auto after = std::ranges::upper_bound(in_chunk, chunk.curve_position[point]) - in_chunk.begin();
        if (const std::size_t i = first + static_cast<std::size_t>(after); i < before.size()) ++before[i];
      });
    } else if (end < before.size()) {
      before[end] += static_cast<std::uint32_t>(shown);
    }
  }
  // So far with the first position only that comes after some points.
  std::partial_sum(before.begin(), before.end(), before.begin());
  for (std::size_t p = 0; p < selection.parts.size(); ++p) {
    const RankChunk& chunk = *selection.parts[p].chunk;
    const auto [first, end] = ranges.next(chunk.id);
    if (first == end || is_sparse(selection.count_of(p), end - first)) continue;
    for (std::size_t layer = 0; layer < chunk.layers(); ++layer) {
      const std::size_t begin = layer * kLayerStrata;
      LayerPrefix shown_before(chunk, begin, &selection.words_of(p)[begin / kWord]);
      for (std::size_t i = first; i < end; ++i) before[i] += shown_before(curve_positions[i]);
    }
  }
}

}  // namespace curvecast
