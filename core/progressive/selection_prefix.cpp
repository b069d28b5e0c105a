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

/// Returns which of some ascending curve positions lie in the chunk's stratum: [first, second).
std::pair<std::size_t, std::size_t> in_stratum(const ChunkId& id, std::span<const std::uint64_t> positions) {
  if (id.level == kChunkLevels) return {0, positions.size()};
  const int bits = 64 - 2 * (id.level - kChunkLevels);
  const auto from = [&](std::uint64_t stratum) {
    const auto at = std::ranges::lower_bound(positions, stratum, {}, [bits](std::uint64_t position) { return position >> bits; });
    return static_cast<std::size_t>(at - positions.begin());
  };
  return {from(id.index), from(id.index + 1)};
}

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
  for (const RankSelection::Part& part : selection.parts) {
    // Positions after the chunk's stratum have all of its points before them: added up below.
    const RankChunk& chunk = *part.chunk;
    const std::size_t end = in_stratum(chunk.id, curve_positions).second;
    if (end < before.size()) before[end] += BitsBelow(&selection.shown[part.first_bit / kWord])(chunk.size());
  }
  std::partial_sum(before.begin(), before.end(), before.begin());
  for (const RankSelection::Part& part : selection.parts) {
    const RankChunk& chunk = *part.chunk;
    const auto [first, end] = in_stratum(chunk.id, curve_positions);
    BitsBelow bits_below(&selection.shown[part.first_bit / kWord]);
    for (std::size_t i = first; i < end; ++i) before[i] += bits_below(first_from(chunk, curve_positions[i]));
  }
}

}  // namespace curvecast
