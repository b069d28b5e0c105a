// Which of the ranked candidates a density shows: a point is there where the scale is at least (rank + 1) / density. A greater
// density or scale only adds points, a smaller one only removes some.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/density/fixed_density.h"
#include "core/density/view_factor.h"
#include "core/sample/rank_tree.h"

namespace curvecast {

/// Kept from frame to frame, so that its memory is used again.
struct RankSelection {
  struct Part {
    std::uint32_t chunk;      // of tree->chunks()
    std::uint32_t first_bit;  // of the chunk's points in `shown`; a multiple of 64
  };

  std::shared_ptr<const RankTree> tree;
  std::vector<Part> parts;           // the chunks with points that are shown, and maybe others, ascending
  std::vector<std::uint64_t> shown;  // a bit for each of their points
  std::size_t count = 0;             // of points shown
  float scale = 0;                   // where fewer points are shown than were asked for: a guess of what all would need
  /// Chunks that may have points to be shown and are not there yet; where none, the selection is what it would be with all
  /// candidates.
  std::vector<ChunkId> lacking;
};

/// Selects for one view after another; not for several threads at once.
class RankSelector {
 public:
  /// The n points that need the least scale under a density, the fixed one (null: 1 everywhere) times the view's; of those that
  /// need the same those of the lowest ranks; fewer where fewer of the tree's have a density. Precondition: n > 0.
  void select(std::shared_ptr<const RankTree> tree, const FixedDensity* density, const ViewFactor& view, std::uint64_t n,
              RankSelection& out);

  /// All points that are shown at a scale.
  void select_at(std::shared_ptr<const RankTree> tree, const FixedDensity* density, const ViewFactor& view, float scale,
                 RankSelection& out);

  /// Held, whether in use or not.
  std::size_t byte_size() const;

 private:
  struct Visited {
    std::uint32_t chunk;
    std::size_t first_key;
  };
  /// A point near the end of the selection.
  struct Candidate {
    float key;
    std::uint32_t rank, key_index;
    bool operator<(const Candidate& other) const { return key < other.key || (key == other.key && rank < other.rank); }
  };

  struct View {
    const RankTree& tree;
    const FixedDensity* density;
    const ViewFactor& factor;
  };

  /// About as many as n points are shown at it, rather more.
  float guess_scale(const View& view, std::uint64_t n);
  /// Finds out what scale each point needs that may be shown at this one. Returns whether that is all points.
  bool visit(const View& view, float scale);
  void evaluate(const View& view, const RankChunk& chunk, std::size_t begin, std::size_t end, float* keys);
  /// Marks as shown the points that need `above` at most, and puts those that need up to `upto` into the window. Returns how many
  /// it marked.
  std::size_t collect(const View& view, float above, float upto);
  void finish(const View& view, std::size_t count, RankSelection& out);

  enum class Visit : std::uint8_t { kLater, kNow, kNever };  // kNever: there is no density at all

  std::vector<Visit> visit_;  // of each chunk
  std::vector<Visited> visited_;
  std::vector<float> most_;  // density, at most, of each run of the visited chunks
  std::vector<float> keys_;  // the scale that each point of the visited chunks needs
  std::vector<float> factor_;
  std::vector<std::uint64_t> shown_, bits_;  // of each key
  std::vector<Candidate> window_;
};

}  // namespace curvecast
