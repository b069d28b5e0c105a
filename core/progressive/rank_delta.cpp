#include "core/progressive/rank_delta.h"

#include <tbb/parallel_invoke.h>

#include <bit>
#include <cstring>

#include "core/progressive/selection_prefix.h"
#include "core/progressive/sort_along_curve.h"

namespace curvecast {
namespace {

constexpr std::size_t kWord = RankSelection::kWord;

constexpr std::uint32_t kNoPart = RankTree::kNone;

/// Calls visit(index of earlier's part or none, index of later's part or none) for every chunk of which either selection has a
/// part.
template <typename Visit>
void for_each_pair(const RankSelection& earlier, const RankSelection& later, const Visit& visit) {
  std::uint32_t e = 0, l = 0;
  while (e < earlier.parts.size() || l < later.parts.size()) {
    const auto order = e == earlier.parts.size() ? std::strong_ordering::greater
                       : l == later.parts.size() ? std::strong_ordering::less
                                                 : earlier.parts[e].chunk->id <=> later.parts[l].chunk->id;
    const std::uint32_t before = order <= 0 ? e++ : kNoPart, after = order >= 0 ? l++ : kNoPart;
    visit(before, after);
  }
}

/// Returns the words of a part's points.
const std::uint64_t* words_of(const RankSelection& selection, std::uint32_t part) {
  return &selection.shown[selection.parts[part].first_bit / kWord];
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

std::uint64_t position_of(const RankSelection& selection, const RankRef& ref) {
  return selection.chunk(ref).curve_position[ref.point];
}

/// Sorts changes along the curve, and writes to `indices` how many points of the later list come before each of them: its index,
/// as no two points share a position. ref(change) is the changed point in the selection.
template <typename Change, typename Ref>
void locate_changes(const RankSelection& selection, std::vector<Change>& changes, const Ref& ref, const RankSelection& later,
                    ListDelta::Scratch& scratch, std::vector<std::uint32_t>& indices) {
  scratch.keys.clear();
  for (std::size_t i = 0; i < changes.size(); ++i) {
    scratch.keys.push_back(curve_key(position_of(selection, ref(changes[i])), i));
  }
  std::vector<Change> sorted;
  sort_along_curve(scratch.keys, scratch.sorting, changes, sorted);
  changes.swap(sorted);
  scratch.curve_positions.clear();
  for (const Change& change : changes) scratch.curve_positions.push_back(position_of(selection, ref(change)));
  indices.resize(changes.size());
  count_selected_before(later, scratch.curve_positions, indices);
}

}  // namespace

void compare(const RankSelection& earlier, std::span<const std::uint8_t> discs, const RankSelection& later, RankDelta& out) {
  out.added.clear();
  out.removed.clear();
  out.resized.clear();
  const bool has_discs = !discs.empty() && !later.rungs.empty();
  Rungs old_rungs(discs), new_rungs(later.rungs);
  for_each_pair(earlier, later, [&](std::uint32_t before, std::uint32_t after) {
    const RankChunk& chunk = after != kNoPart ? *later.parts[after].chunk : *earlier.parts[before].chunk;
    const std::size_t words = chunk.size() / kWord;
    const std::uint64_t* const old_words = before != kNoPart ? words_of(earlier, before) : nullptr;
    const std::uint64_t* const new_words = after != kNoPart ? words_of(later, after) : nullptr;
    for (std::size_t w = 0; w < words; ++w) {
      const std::uint64_t was = old_words != nullptr ? old_words[w] : 0;
      const std::uint64_t is = new_words != nullptr ? new_words[w] : 0;
      // As a rule nothing changes among 64 points.
      if (was == is && (!has_discs || skip_same(static_cast<std::size_t>(std::popcount(is)), old_rungs, new_rungs))) continue;
      // Without discs only points come and go; with discs the rungs of all points have to be read, in the order of their bits.
      for_each_bit(has_discs ? was | is : was ^ is, w * kWord, [&](std::size_t i) {
        const auto point = static_cast<std::uint16_t>(i);
        const bool is_old = (was >> i % kWord & 1) != 0, is_new = (is >> i % kWord & 1) != 0;
        const std::uint8_t from = has_discs && is_old ? old_rungs.next() : std::uint8_t{0};
        const std::uint8_t to = has_discs && is_new ? new_rungs.next() : std::uint8_t{0};
        if (is_old && is_new) {
          if (from != to) out.resized.push_back({{after, point, to}, from});
        } else if (is_new) {
          out.added.push_back({after, point, to});
        } else {
          out.removed.push_back({before, point, from});
        }
      });
    }
  });
}

void locate(const RankSelection& earlier, const RankSelection& later, RankDelta& delta, ListDelta& out) {
  const auto itself = [](const RankRef& ref) -> const RankRef& { return ref; };
  const auto point_of = [](const RankDelta::Resized& resized) -> const RankRef& { return resized.point; };
  tbb::parallel_invoke([&] { locate_changes(later, delta.resized, point_of, later, out.of_resized, out.resized); },
                       [&] { locate_changes(later, delta.added, itself, later, out.of_added, out.added); },
                       [&] { locate_changes(earlier, delta.removed, itself, later, out.of_removed, out.removed); });
  // So far the removed points have the indices that they would have in the later list. Of the points before it, the earlier list
  // lacks those that were added, and has those that were removed.
  std::size_t added = 0;
  for (std::size_t i = 0; i < out.removed.size(); ++i) {
    while (added < out.added.size() && out.added[added] < out.removed[i]) ++added;
    out.removed[i] += static_cast<std::uint32_t>(i) - static_cast<std::uint32_t>(added);
  }
}

}  // namespace curvecast
