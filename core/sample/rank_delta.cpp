#include "core/sample/rank_delta.h"

#include <bit>

#include "core/sample/place_order.h"

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
  return std::uint64_t{tree.chunks()[ref.chunk]->place[ref.point]} << 32 | value;
}

/// Brings changes, ref(change) of a tree, into the order of the curve.
template <typename Change, typename Ref>
void sort_changes(const RankTree& tree, std::vector<Change>& changes, const Ref& ref, ListDelta& memory) {
  std::vector<std::uint64_t>& keys = memory.keys;
  keys.clear();
  for (std::size_t i = 0; i < changes.size(); ++i) keys.push_back(key_of(tree, ref(changes[i]), i));
  sort_by_place(keys, memory.scratch);
  std::vector<Change> sorted;
  sorted.reserve(changes.size());
  for (const std::uint64_t key : keys) sorted.push_back(changes[static_cast<std::uint32_t>(key)]);
  changes.swap(sorted);
}

}  // namespace

void compare(const RankSelection& earlier, const RankSelection& later, RankDelta& out) {
  out.added.clear();
  out.removed.clear();
  out.resized.clear();
  const bool has_discs = !earlier.rungs.empty() && !later.rungs.empty();
  std::size_t old_rung = 0, new_rung = 0;  // of the next point that each shows
  for_each_pair(earlier, later, [&](const RankSelection::Part* before, const RankSelection::Part* after) {
    const RankChunk& chunk = after != nullptr ? *later.tree->chunks()[after->chunk] : *earlier.tree->chunks()[before->chunk];
    for (std::size_t w = 0; w < chunk.size() / kWord; ++w) {
      const std::uint64_t was = before != nullptr ? earlier.shown[before->first_bit / kWord + w] : 0;
      const std::uint64_t is = after != nullptr ? later.shown[after->first_bit / kWord + w] : 0;
      for_each_bit(has_discs ? was | is : was ^ is, 0, [&](std::size_t bit) {
        const auto point = static_cast<std::uint16_t>(w * kWord + bit);
        const bool is_old = (was >> bit & 1) != 0, is_new = (is >> bit & 1) != 0;
        const std::uint8_t from = has_discs && is_old ? earlier.rungs[old_rung++] : std::uint8_t{0};
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

void locate(const RankSelection& earlier, const RankSelection& later, RankDelta& delta, ListDelta& out) {
  const RankTree& old_tree = *earlier.tree;
  const RankTree& tree = *later.tree;
  const auto itself = [](const RankRef& ref) { return ref; };
  sort_changes(tree, delta.added, itself, out);
  sort_changes(old_tree, delta.removed, itself, out);
  sort_changes(
      tree, delta.resized, [](const RankDelta::Resized& resized) { return resized.point; }, out);
  // All that either list has. No two points share a place.
  out.keys.clear();
  later.for_each_shown([&](const RankRef& ref, std::size_t) { out.keys.push_back(key_of(tree, ref, 0)); });
  for (const RankRef& ref : delta.removed) out.keys.push_back(key_of(old_tree, ref, 1));
  sort_by_place(out.keys, out.scratch);
  out.added.clear();
  out.removed.clear();
  out.resized.clear();
  std::uint32_t in_earlier = 0, in_later = 0;
  for (const std::uint64_t key : out.keys) {
    if ((key & 1) != 0) {
      out.removed.push_back(in_earlier++);
      continue;
    }
    if (out.added.size() < delta.added.size() && key == key_of(tree, delta.added[out.added.size()], 0)) {
      out.added.push_back(in_later++);
      continue;
    }
    if (out.resized.size() < delta.resized.size() && key == key_of(tree, delta.resized[out.resized.size()].point, 0)) {
      out.resized.push_back(in_later);
    }
    ++in_earlier;
    ++in_later;
  }
}

}  // namespace curvecast
