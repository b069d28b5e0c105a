#include "core/progressive/shown_before.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "core/base/lanes.h"
#include "core/progressive/progressive.h"

namespace curvecast {
namespace {

constexpr std::size_t kWord = RankSelection::kWord;

/// The first of a chunk's points whose place is not less than one in the chunk's stratum. Each stratum of its level has a point;
/// where the chunk continues others, one in every four is theirs.
std::size_t first_from(const RankChunk& chunk, std::uint32_t place) {
  static_assert(2 * kMaxRankLevel <= 32, "places tell strata apart");
  const std::size_t stratum = place >> (32 - 2 * chunk.id.level) & (kChunkStrata - 1);
  const std::uint32_t* const places = chunk.place.data();
  const auto is_before = [&](std::size_t i) { return places[i] < place ? std::size_t{1} : std::size_t{0}; };
  if (chunk.id.level == kChunkLevels) return stratum + is_before(stratum);
  const std::size_t first = stratum / 4 * 3;
  return first + is_before(first) + is_before(first + 1) + is_before(first + 2);
}

/// Of places that ascend, those in the chunk's stratum: [first, second).
std::pair<std::size_t, std::size_t> in_stratum(const ChunkId& id, std::span<const std::uint32_t> places) {
  const int bits = 32 - 2 * (id.level - kChunkLevels);
  const auto from = [&](std::uint64_t place) {
    return static_cast<std::size_t>(std::ranges::lower_bound(places, place) - places.begin());
  };
  return {from(id.index << bits), from((id.index + 1) << bits)};
}

/// Counts the bits below a place of a row of them; asked for one place after the other, ascending.
class BitsBelow {
 public:
  explicit BitsBelow(const std::uint64_t* words) : words_(words) {}
  std::uint32_t operator()(std::size_t place) {
    for (; word_ < place / kWord; ++word_) count_ += std::popcount(words_[word_]);
    const std::size_t rest = place % kWord;
    const int more = rest == 0 ? 0 : std::popcount(words_[word_] << (kWord - rest));
    return static_cast<std::uint32_t>(count_ + more);
  }

 private:
  const std::uint64_t* words_;
  std::size_t word_ = 0;
  int count_ = 0;
};

}  // namespace

CURVECAST_WIDE void count_shown_before(const RankSelection& selection, std::span<const std::uint32_t> places,
                                       std::span<std::uint32_t> before) {
  std::ranges::fill(before, 0);
  for (const RankSelection::Part& part : selection.parts) {
    // What comes after the chunk has all of its points before it: added up below.
    const RankChunk& chunk = *selection.tree->chunks()[part.chunk];
    const std::size_t end = in_stratum(chunk.id, places).second;
    if (end < before.size()) before[end] += BitsBelow(&selection.shown[part.first_bit / kWord])(chunk.size());
  }
  std::partial_sum(before.begin(), before.end(), before.begin());
  for (const RankSelection::Part& part : selection.parts) {
    const RankChunk& chunk = *selection.tree->chunks()[part.chunk];
    const auto [first, end] = in_stratum(chunk.id, places);
    BitsBelow bits_below(&selection.shown[part.first_bit / kWord]);
    for (std::size_t i = first; i < end; ++i) before[i] += bits_below(first_from(chunk, places[i]));
  }
}

}  // namespace curvecast
