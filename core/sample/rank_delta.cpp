#include "core/sample/rank_delta.h"

#include <bit>

namespace curvecast {
namespace {

constexpr std::size_t kWord = 64;

/// Calls visit(point) for every bit that is set.
template <typename Visit>
void for_each_bit(std::uint64_t word, std::size_t first, const Visit& visit) {
  for (; word != 0; word &= word - 1) visit(static_cast<std::uint32_t>(first + static_cast<std::size_t>(std::countr_zero(word))));
}

/// The parts of two selections that belong to the same chunk: visit(earlier's part or null, later's part or null).
template <typename Visit>
void for_each_pair(const RankSelection& earlier, const RankSelection& later, const Visit& visit) {
  std::size_t e = 0, l = 0;
  while (e < earlier.parts.size() || l < later.parts.size()) {
    const RankSelection::Part* const a = e < earlier.parts.size() ? &earlier.parts[e] : nullptr;
    const RankSelection::Part* const b = l < later.parts.size() ? &later.parts[l] : nullptr;
    const auto order = a == nullptr   ? std::strong_ordering::greater
                       : b == nullptr ? std::strong_ordering::less
                                      : earlier.tree->chunks()[a->chunk]->id <=> later.tree->chunks()[b->chunk]->id;
    if (order <= 0) ++e;
    if (order >= 0) ++l;
    visit(order <= 0 ? a : nullptr, order >= 0 ? b : nullptr);
  }
}

}  // namespace

void list_shown(const RankSelection& selection, std::vector<RankRef>& out) {
  out.clear();
  out.reserve(selection.count);
  for (const RankSelection::Part& part : selection.parts) {
    const std::size_t words = selection.tree->chunks()[part.chunk]->size() / kWord;
    for (std::size_t w = 0; w < words; ++w) {
      for_each_bit(selection.shown[part.first_bit / kWord + w], w * kWord, [&](std::uint32_t point) {
        out.push_back({part.chunk, point});
      });
    }
  }
}

void compare(const RankSelection& earlier, const RankSelection& later, RankDelta& out) {
  out.added.clear();
  out.removed.clear();
  for_each_pair(earlier, later, [&](const RankSelection::Part* before, const RankSelection::Part* after) {
    const RankChunk& chunk = after != nullptr ? *later.tree->chunks()[after->chunk] : *earlier.tree->chunks()[before->chunk];
    for (std::size_t w = 0; w < chunk.size() / kWord; ++w) {
      const std::uint64_t was = before != nullptr ? earlier.shown[before->first_bit / kWord + w] : 0;
      const std::uint64_t is = after != nullptr ? later.shown[after->first_bit / kWord + w] : 0;
      for_each_bit(is & ~was, w * kWord, [&](std::uint32_t point) { out.added.push_back({after->chunk, point}); });
      for_each_bit(was & ~is, w * kWord, [&](std::uint32_t point) { out.removed.push_back(chunk.rank[point]); });
    }
  });
}

}  // namespace curvecast
