#include "core/progressive/rank_delta.h"

#include <bit>
#include <cstring>

#include "core/progressive/selection_prefix.h"
#include "core/progressive/sort_along_curve.h"

namespace curvecast {
namespace {

constexpr std::size_t kWord = RankSelection::kWord;

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

std::uint64_t key_of(const RankTree& tree, const RankRef& ref, std::uint64_t value) {
  return std::uint64_t{tree.chunks()[ref.chunk]->curve_position[ref.point]} << 32 | value;
}

/// Sorts changes along the curve; ref(change) is the changed point in the tree.
template <typename Change, typename Ref>
void sort_changes(const RankTree& tree, std::vector<Change>& changes, const Ref& ref, ListDelta& memory) {
  std::vector<std::uint64_t>& keys = memory.keys;
  keys.clear();
  for (std::size_t i = 0; i < changes.size(); ++i) keys.push_back(key_of(tree, ref(changes[i]), i));
  sort_along_curve(keys, memory.scratch);
  std::vector<Change> sorted;
  sorted.reserve(changes.size());
  for (const std::uint64_t key : keys) sorted.push_back(changes[static_cast<std::uint32_t>(key)]);
  changes.swap(sorted);
}

}  // namespace

void compare(const RankSelection& earlier, std::span<const std::uint8_t> discs, const RankSelection& later, RankDelta& out) {
  out.added.clear();
  out.removed.clear();
  out.resized.clear();
  const bool has_discs = !discs.empty() && !later.rungs.empty();
  std::size_t old_rung = 0, new_rung = 0;  // of the next point that each shows
  for_each_pair(earlier, later, [&](const RankSelection::Part* before, const RankSelection::Part* after) {
    const RankChunk& chunk = after != nullptr ? *later.tree->chunks()[after->chunk] : *earlier.tree->chunks()[before->chunk];
    for (std::size_t w = 0; w < chunk.size() / kWord; ++w) {
      const std::uint64_t was = before != nullptr ? earlier.shown[before->first_bit / kWord + w] : 0;
      const std::uint64_t is = after != nullptr ? later.shown[after->first_bit / kWord + w] : 0;
      if (was == is) {  // as a rule
        const auto count = static_cast<std::size_t>(std::popcount(is));
        if (!has_discs) continue;
        if (std::memcmp(discs.data() + old_rung, later.rungs.data() + new_rung, count) == 0) {
          old_rung += count;
          new_rung += count;
          continue;
        }
      }
      for_each_bit(has_discs ? was | is : was ^ is, 0, [&](std::size_t bit) {
        const auto point = static_cast<std::uint16_t>(w * kWord + bit);
        const bool is_old = (was >> bit & 1) != 0, is_new = (is >> bit & 1) != 0;
        const std::uint8_t from = has_discs && is_old ? discs[old_rung++] : std::uint8_t{0};
        const std::uint8_t to = has_discs && is_new ? later.rungs[new_rung++] : std::uint8_t{0};
        if (is_old && is_new) {
          if (from != to) out.resized.push_back({{after->chunk, point, to}, from});
        } else if (is_new) {
          out.added.push_back({after->chunk, point, to});
        } else {
          out.removed.push_back({before->chunk, point, from});
        }
      });
    }
  });
}

void locate(const RankTree& earlier, const RankSelection& later, RankDelta& delta, ListDelta& out) {
  const RankTree& tree = *later.tree;
  const auto itself = [](const RankRef& ref) -> const RankRef& { return ref; };
  const auto point_of = [](const RankDelta::Resized& resized) -> const RankRef& { return resized.point; };
  sort_changes(tree, delta.added, itself, out);
  sort_changes(earlier, delta.removed, itself, out);
  sort_changes(tree, delta.resized, point_of, out);
  // An index is the number of points of the later list that come before: no two points share a curve position.
  const auto find = [&](const RankTree& in, const auto& changes, const auto& ref_of, std::vector<std::uint32_t>& indices) {
    out.curve_positions.clear();
    for (const auto& change : changes) {
      const RankRef& ref = ref_of(change);
      out.curve_positions.push_back(in.chunks()[ref.chunk]->curve_position[ref.point]);
    }
    indices.resize(out.curve_positions.size());
    count_selected_before(later, out.curve_positions, indices);
  };
  find(tree, delta.resized, point_of, out.resized);
  find(tree, delta.added, itself, out.added);
  find(earlier, delta.removed, itself, out.removed);
  // The earlier list has not yet those that were added, and still those that were removed.
  std::size_t added = 0;
  for (std::size_t i = 0; i < out.removed.size(); ++i) {
    while (added < out.added.size() && out.added[added] < out.removed[i]) ++added;
    out.removed[i] += static_cast<std::uint32_t>(i) - static_cast<std::uint32_t>(added);
  }
}

}  // namespace curvecast
