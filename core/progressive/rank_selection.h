// Selects the ranked points that a density shows: those that need a scale of at most s, where a point needs (rank + 1) / density.
// A greater density or scale only adds points, a smaller one only removes some.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <tuple>
#include <vector>

#include "core/base/capacity.h"
#include "core/density/fixed_density.h"
#include "core/density/view_factor.h"
#include "core/progressive/rank_tree.h"

namespace curvecast {

/// Names a point that a selection shows.
struct RankRef {
  std::uint32_t part;   // of the selection, which says which chunk
  std::uint16_t point;  // of the chunk
  std::uint8_t rung;    // of its disc, see RadiusLadder; 0 where it is not known
};
static_assert(kChunkStrata <= std::uint64_t{1} << 16);

/// Calls visit(first + i) for every bit i that is set in a word, ascending.
template <typename Visit>
void for_each_bit(std::uint64_t word, std::size_t first, const Visit& visit) {
  for (; word != 0; word &= word - 1) visit(first + static_cast<std::size_t>(std::countr_zero(word)));
}

/// The ranked points that a view shows. Kept from frame to frame, so that its memory is used again.
struct RankSelection {
  static constexpr std::size_t kWord = 64;

  struct Part {
    RankTree::Chunk chunk;
    std::uint32_t first_bit;                // of the chunk's points in `shown`; a multiple of 64
    std::uint32_t index = RankTree::kNone;  // of the chunk in tree->chunks()
  };

  std::shared_ptr<const RankTree> tree;  // from which it was selected; null where only what is shown is kept
  std::vector<Part> parts;               // all chunks with points that are shown, and maybe others, ascending by id
  std::vector<std::uint64_t> shown;      // a bit for each of their points
  std::size_t count = 0;                 // of points shown
  // Rungs of the discs of the points shown on the curve's RadiusLadder, in the order of their bits; none where not known.
  std::vector<std::uint8_t> rungs;
  float scale = 0;    // the largest that a point shown needs; a guess where fewer points are shown than were asked for
  double pixels = 0;  // of the view: ViewFactor::pixels()
  /// Chunks that are not in the tree and may have points to be shown. Without any the selection is what it would be with all
  /// chunks. First come the `urgent` ones, to be made before the others: what they show tells whether those are needed at all.
  std::vector<ChunkId> lacking;
  std::size_t urgent = 0;
  /// Somewhere the density shows more points than level kMaxRankLevel has.
  bool is_exhausted = false;

  /// Bytes allocated, in use or not; the tree is shared and not counted.
  std::size_t byte_size() const {
    const auto& [t, p, s, c, r, f, x, l, u, e] = *this;
    return capacity_bytes(p, s, r, l);
  }

  /// Returns the chunks that are lacking and urgent.
  std::span<const ChunkId> most_lacking() const { return std::span(lacking).first(urgent); }

  /// Returns the scale in a unit in which those of similar views are similar: points per pixel, where the view's density is one
  /// of pixels. (That of a ScreenTerm is relative to the nearest that may be seen.)
  double similar_scale() const { return pixels > 0 ? static_cast<double>(scale) / pixels : static_cast<double>(scale); }

  const RankChunk& chunk(const RankRef& ref) const { return *parts[ref.part].chunk; }

  /// Returns the bits of a part's points.
  std::span<const std::uint64_t> words_of(std::size_t part) const {
    return std::span(shown).subspan(parts[part].first_bit / kWord, parts[part].chunk->size() / kWord);
  }
  /// Returns how many points of a part are shown.
  std::size_t count_of(std::size_t part) const {
    std::size_t sum = 0;
    for (const std::uint64_t word : words_of(part)) sum += static_cast<std::size_t>(std::popcount(word));
    return sum;
  }
  /// Calls visit(point) for every point of a part that is shown, ascending.
  template <typename Visit>
  void for_each_shown_of(std::size_t part, const Visit& visit) const {
    std::size_t first = 0;
    for (const std::uint64_t word : words_of(part)) {
      for_each_bit(word, first, visit);
      first += kWord;
    }
  }
  /// Calls visit(RankRef, index of its bit) for every point shown: chunk by chunk, ascending in each.
  template <typename Visit>
  void for_each_shown(const Visit& visit) const {
    std::size_t i = 0;
    for (std::uint32_t p = 0; p < parts.size(); ++p) {
      for_each_shown_of(p, [&](std::size_t point) {
        const std::uint8_t rung = rungs.empty() ? std::uint8_t{0} : rungs[i++];
        visit(RankRef{p, static_cast<std::uint16_t>(point), rung}, parts[p].first_bit + point);
      });
    }
  }
};

/// Selects points for one view after another, in memory that is used again. Not for several threads at once.
class RankSelector {
 public:
  /// `is_parallel`: a selection uses all cores, for the sake of who waits for it; what it selects does not depend on it.
  explicit RankSelector(bool is_parallel = false) : is_parallel_(is_parallel) {}

  /// Selects the n > 0 points that need the least scale; of points that need the same, those of lower ranks. Selects fewer where
  /// fewer points of the tree have a density. The density is the fixed one (null: 1 everywhere) times the view's;
  /// what is fixed by detail alone the points know themselves.
  /// `expected_scale`: about the similar_scale() of the result; 0: not known. It makes no difference but of time.
  void select(std::shared_ptr<const RankTree> tree, const FixedDensity* density, const ViewFactor& view, std::uint64_t n,
              RankSelection& out, double expected_scale = 0);

  /// Writes the density at the points that the last selection shows, selection.count of them in the order of their bits.
  void densities(const RankSelection& selection, std::span<float> out) const;

  /// Bytes allocated, in use or not.
  std::size_t byte_size() const;

 private:
  struct Visited {
    std::uint32_t chunk;
    std::size_t first_key;
    std::size_t layers = 0;  // that have points which may be shown: only these have keys, and bits in bits_
    std::size_t below = 0;   // points marked in shown_
  };
  /// A point that may be among the last of the selection.
  struct WindowPoint {
    float key;
    std::uint64_t rank;
    std::uint32_t key_index;
    bool operator<(const WindowPoint& other) const {
      return std::tie(key, rank, key_index) < std::tie(other.key, other.rank, other.key_index);
    }
  };

  struct View {
    const RankTree& tree;
    const FixedDensity* density;
    const ViewFactor& factor;
  };

  /// Returns a scale at which about n points are shown, as the lowest ranks have it; 0 where hardly any of them are in view.
  float guess_scale(const View& view, std::uint64_t n);
  /// Does the same from all points that were visited; 0 where nothing has a density. Precondition: all keys are known.
  float measure_scale(const View& view, std::uint64_t n) const;
  /// Returns a bound of the density in a quarter of a visited chunk's stratum.
  float quarter_bound(std::size_t v, std::size_t quarter) const;
  /// Writes out.lacking, out.urgent and out.is_exhausted, for out.scale.
  void find_lacking(const View& view, RankSelection& out);
  /// Says whether any visited chunk has no child where there is a density.
  bool any_lacking(const View& view) const;
  /// Visits the chunks with points that may be shown at a scale, finds the scale that each of their points needs, and marks those
  /// that need a little less, and those that need this one. Returns whether all points of the tree that have a density are among
  /// them.
  bool visit(const View& view, float scale);
  /// Calls work(v, end) for all visited chunks v: for each thread one after another below its end.
  template <typename Work>
  void for_each_visited(const Work& work);
  /// Writes to `most` the largest density that points in each of a chunk's runs may have, points of deeper chunks included.
  static void bound_runs(const View& view, const RankChunk& chunk, float* most);
  /// Writes the keys of the points of a chunk's first layers; infinity in runs that show no point at the scale.
  static void fill_keys(const View& view, const RankChunk& chunk, std::size_t layers, const float* most, float scale,
                        float* keys);
  /// Writes the density at some of a chunk's points; `is_beside`: some of them may lie beside a crease.
  static void evaluate(const View& view, const RankChunk& chunk, std::size_t begin, std::size_t end, bool is_beside,
                       float* density);
  /// Marks the points of visited chunks, or of one of them, that need `above` at most, in shown_, and those that need `upto` at
  /// most, in bits_.
  void mark(float above, float upto);
  void mark(std::size_t v, float above, float upto);
  /// Puts the points that are marked in bits_ alone into the window. Returns how many are marked in shown_.
  std::size_t collect(const View& view);
  void finish(const View& view, std::size_t count, RankSelection& out);

  /// What visit() does with a chunk. It is decided with the parent: chunks below a chunk that waits wait too.
  enum class State : std::uint8_t {
    kWaits,    // shows no point at this scale, but may at a greater one
    kVisited,  // may show points
    kEmpty,    // shows no point at any scale: there is no density
  };

  const bool is_parallel_;
  std::vector<State> states_;  // of each chunk
  std::vector<Visited> visited_;
  std::vector<float> most_;                  // bound_runs() of the visited chunks
  std::vector<float> keys_;                  // the scale that each point of the visited chunks needs
  std::vector<std::uint64_t> shown_, bits_;  // of each key
  std::vector<WindowPoint> window_;
  std::vector<std::pair<double, ChunkId>> lacking_;  // with the most ranks that they show, over their first
};

}  // namespace curvecast
