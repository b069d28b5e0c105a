#include "core/progressive/rank_delta.h"

#include <bit>
#include <cstring>

#include "core/progressive/selection_prefix.h"
#include "core/progressive/sort_along_curve.h"

namespace curvecast {
namespace {

constexpr std::size_t kWord = RankSelection::kWord;

/// Calls visit(earlier's part or null, later's part or null) for every chunk of which either selection has a part.
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

std::size_t words_of(const RankSelection& selection, const RankSelection::Part& part) {
  return selection.tree->chunks()[part.chunk]->size() / kWord;
}

/// Reads the rungs of a selection's points one after another.
class Rungs {
 public:
  explicit Rungs(std::span<const std::uint8_t> rungs) : rest_(rungs.data()) {}
  std::uint8_t next() { return *rest_++; }

  friend bool skip_same(std::size_t count, Rungs& a, Rungs& b);

 private:
  const std::uint8_t* rest_;
};

/// Skips the next rungs of both, if all of them are the same.
bool skip_same(std::size_t count, Rungs& a, Rungs& b) {
  if (std::memcmp(a.rest_, b.rest_, count) != 0) return false;
  a.rest_ += count;
  b.rest_ += count;
  return true;
}

std::uint32_t position_of(const RankTree& tree, const RankRef& ref) {
  return tree.chunks()[ref.chunk]->curve_position[ref.point];
}

/// Sorts changes along the curve; ref(change) is the changed point in the tree.
template <typename Change, typename Ref>
void sort_changes(const RankTree& tree, std::vector<Change>& changes, const Ref& ref, ListDelta& memory) {
  std::vector<std::uint64_t>& keys = memory.keys;
  keys.clear();
  for (std::size_t i = 0; i < changes.size(); ++i) keys.push_back(std::uint64_t{position_of(tree, ref(changes[i]))} << 32 | i);
  std::vector<Change> sorted;
  sort_along_curve(keys, memory.scratch, changes, sorted);
  changes.swap(sorted);
}

/// Writes to `indices` how many points of the later list come before each change: its index, as no two points share a position.
template <typename Change, typename Ref>
void find_indices(const RankTree& tree, const std::vector<Change>& changes, const Ref& ref, const RankSelection& later,
                  std::vector<std::uint32_t>& positions, std::vector<std::uint32_t>& indices) {
  positions.clear();
  for (const Change& change : changes) positions.push_back(position_of(tree, ref(change)));
  indices.resize(positions.size());
  count_selected_before(later, positions, indices);
}

}  // namespace

void compare(const RankSelection& earlier, std::span<const std::uint8_t> discs, const RankSelection& later, RankDelta& out) {
  out.added.clear();
  out.removed.clear();
  out.resized.clear();
  const bool has_discs = !discs.empty() && !later.rungs.empty();
  Rungs old_rungs(discs), new_rungs(later.rungs);
  for_each_pair(earlier, later, [&](const RankSelection::Part* before, const RankSelection::Part* after) {
    const std::size_t words = after != nullptr ? words_of(later, *after) : words_of(earlier, *before);
    for (std::size_t w = 0; w < words; ++w) {
      const std::uint64_t was = before != nullptr ? earlier.shown[before->first_bit / kWord + w] : 0;
      const std::uint64_t is = after != nullptr ? later.shown[after->first_bit / kWord + w] : 0;
      // As a rule nothing changes among 64 points.
      if (was == is && (!has_discs || skip_same(static_cast<std::size_t>(std::popcount(is)), old_rungs, new_rungs))) continue;
      // Without discs only points come and go; with discs the rungs of all points have to be read, in the order of their bits.
      for_each_bit(has_discs ? was | is : was ^ is, w * kWord, [&](std::size_t i) {
        const auto point = static_cast<std::uint16_t>(i);
        const bool is_old = (was >> i % kWord & 1) != 0, is_new = (is >> i % kWord & 1) != 0;
        const std::uint8_t from = has_discs && is_old ? old_rungs.next() : std::uint8_t{0};
        const std::uint8_t to = has_discs && is_new ? new_rungs.next() : std::uint8_t{0};
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
  find_indices(tree, delta.resized, point_of, later, out.curve_positions, out.resized);
  find_indices(tree, delta.added, itself, later, out.curve_positions, out.added);
  find_indices(earlier, delta.removed, itself, later, out.curve_positions, out.removed);
  // So far the removed points have the indices that they would have in the later list. Of the points before it, the earlier list
  // lacks those that were added, and has those that were removed.
  std::size_t added = 0;
  for (std::size_t i = 0; i < out.removed.size(); ++i) {
    while (added < out.added.size() && out.added[added] < out.removed[i]) ++added;
    out.removed[i] += static_cast<std::uint32_t>(i) - static_cast<std::uint32_t>(added);
  }
}

}  // namespace curvecast
