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

/// Returns the first of a chunk's points that is not before `position`, which lies in the chunk's stratum. Each stratum of the
/// chunk's level has one point; of four strata one has its point in a chunk of a lower level, but for the first chunk.
std::size_t first_from(const RankChunk& chunk, std::uint64_t position) {
  const std::size_t stratum = position >> (64 - 2 * chunk.id.level) & (kChunkStrata - 1);
  const std::uint64_t* const positions = chunk.curve_position.data();
  const auto is_before = [&](std::size_t i) { return positions[i] < position ? std::size_t{1} : std::size_t{0}; };
  if (chunk.id.level == kChunkLevels) return stratum + is_before(stratum);
  const std::size_t first = stratum / 4 * 3;
  return first + is_before(first) + is_before(first + 1) + is_before(first + 2);
}

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

/// Counts the bits below an index in a row of words; the indices asked for must ascend.
class BitsBelow {
 public:
  explicit BitsBelow(const std::uint64_t* words) : words_(words) {}
  std::uint32_t operator()(std::size_t index) {
    for (; word_ < index / kWord; ++word_) count_ += std::popcount(words_[word_]);
    const std::size_t rest = index % kWord;
    const int more = rest == 0 ? 0 : std::popcount(words_[word_] << (kWord - rest));
    return static_cast<std::uint32_t>(count_ + more);
  }

 private:
  const std::uint64_t* words_;
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
    BitsBelow bits_below(selection.words_of(p).data());
    for (std::size_t i = first; i < end; ++i) before[i] += bits_below(first_from(chunk, curve_positions[i]));
  }
}

}  // namespace curvecast
