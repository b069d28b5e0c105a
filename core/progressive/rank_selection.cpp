#include "core/progressive/rank_selection.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <utility>

#include "core/base/simd.h"
#include "core/progressive/progressive.h"

namespace curvecast {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kSlack = 1.0001f;    // bounds are rounded, points too
constexpr double kMostScale = 1e30;  // of a guess, which must stay finite
constexpr std::size_t kWord = RankSelection::kWord;
constexpr float kMore = 1.05f, kFewer = 0.93f, kFaster = 4;  // README.md says where these come from
// A chunk is urgent that lacks ranks at least this many times as much as the one that lacks them most: down to a level less.
constexpr double kUrgent = 0.25;
constexpr std::size_t kAhead = 4;   // chunks whose bounds the memory brings beforehand
constexpr std::size_t kGrain = 16;  // chunks that a thread takes at once
constexpr std::size_t kQuarterRuns = kChunkRuns / 4;

static_assert(kLayerStrata % kWord == 0, "layers fill whole words");

/// Returns (rank + 1) / density, the scale that a point needs.
[[gnu::always_inline]] inline float to_key(std::uint32_t rank, float step, float density) {
  return static_cast<float>(static_cast<std::int32_t>(rank) + 1) * step / density;
}

/// Writes the scales that points need.
CURVECAST_WIDE void to_keys(const std::uint32_t* __restrict rank, float step, const float* __restrict density, std::size_t n,
                            float* __restrict key) {
  for (std::size_t i = 0; i < n; ++i) key[i] = to_key(rank[i], step, density[i]);
}

/// Sets a bit for each key that is at most `upto`. Returns how many bits it set.
CURVECAST_WIDE std::size_t mark_upto(const float* key, std::size_t words, float upto, std::uint64_t* bits) {
  std::size_t count = 0;
  for (std::size_t w = 0; w < words; ++w, key += kWord) {
    std::uint8_t flags[kWord];
    for (std::size_t i = 0; i < kWord; ++i) flags[i] = key[i] <= upto ? 1 : 0;
    std::uint64_t word = 0;
    for (std::size_t byte = 0; byte < 8; ++byte) {
      std::uint64_t eight;
      std::memcpy(&eight, flags + 8 * byte, sizeof(eight));
      word |= (eight * 0x0102040810204080u >> 56) << 8 * byte;  // the lowest bit of each byte, side by side
    }
    bits[w] = word;
    count += static_cast<std::size_t>(std::popcount(word));
  }
  return count;
}

/// Says whether no point of a layer of the chunk, or of later layers, or of chunks below it, is shown at the scale where the
/// density is at most `most`.
bool needs_none(const ChunkId& id, float most, float scale, std::size_t layer = 0) {
  return static_cast<double>(most) * static_cast<double>(kSlack) * static_cast<double>(scale) <
         static_cast<double>(id.first_rank(layer)) + 1;
}

/// Brings memory nearer that is read soon.
void prefetch(const void* first, std::size_t bytes) {
  const auto begin = reinterpret_cast<std::uintptr_t>(first);
  for (std::uintptr_t at = begin / kCacheLine * kCacheLine; at < begin + bytes; at += kCacheLine) {
    __builtin_prefetch(reinterpret_cast<const void*>(at));
  }
}

/// Does so for what evaluate() reads of runs that may show points. Between two views other work has had the caches, and chunks
/// are too short for a processor to foresee what is read.
void prefetch_runs(const RankChunk& chunk, const float* most, float scale) {
  for (std::size_t layer = 0; layer < chunk.layers(); ++layer) {
    for (std::size_t r = 0; r < kChunkRuns; ++r) {
      if (needs_none(chunk.id, most[r], scale, layer)) continue;
      const std::size_t first = layer * kLayerStrata + r * kRunPoints;
      const auto prefetch_all = [&](const auto&... column) { (prefetch(&column[first], kRunPoints * sizeof(column[0])), ...); };
      prefetch_all(chunk.x, chunk.y, chunk.z, chunk.nx, chunk.ny, chunk.nz, chunk.detail, chunk.rank);
      if ((chunk.runs_beside >> r & 1) != 0) prefetch_all(chunk.beside);
    }
  }
}

/// Does so for where that is.
void prefetch_columns(const RankChunk& chunk) { prefetch(&chunk, offsetof(RankChunk, bounds)); }

/// Says whether all points of a chunk, and of chunks below it, that have a density may be shown.
bool shows_all(const RankChunk& chunk, const float* most, float scale) {
  return std::all_of(most, most + kChunkRuns,
                     [&](float m) { return m == 0 || !needs_none(chunk.id, m, scale, chunk.layers() - 1); });
}

}  // namespace

void RankSelector::select(std::shared_ptr<const RankTree> tree, const FixedDensity* density, const ViewFactor& factor,
                          std::uint64_t n, RankSelection& out, double expected_scale) {
  const View view{*tree, density, factor};
  out.pixels = factor.pixels();
  const double expected = expected_scale * (out.pixels > 0 ? out.pixels : 1);
  float guess = expected > 0 ? static_cast<float>(std::min(expected, kMostScale)) : guess_scale(view, n);
  // Where nothing tells, all that there is in view is looked at, and tells.
  const bool is_known = guess > 0;
  float scale = is_known ? kMore * guess : std::numeric_limits<float>::max(), above = 0;
  bool is_all = visit(view, scale);
  if (!is_known && (guess = measure_scale(view, n)) > 0) {
    scale = kMore * guess;
    mark(kFewer * scale, scale);
  }
  std::size_t below = 0;
  for (;;) {
    above = kFewer * scale;
    below = collect(view);
    const std::size_t found = below + window_.size();
    if (found >= n) break;
    if (is_all) {
      scale = std::numeric_limits<float>::max();
      break;
    }
    // About as many more points as the scale is larger.
    const float more = kMore * static_cast<float>(n) / static_cast<float>(std::max<std::size_t>(found, 1));
    scale = std::min(scale * std::clamp(more, kMore, kFaster), std::numeric_limits<float>::max());
    is_all = visit(view, scale);
  }
  while (below >= n) {
    scale = above;
    above *= kFewer * static_cast<float>(n) / static_cast<float>(below);
    mark(above, scale);
    below = collect(view);
  }
  if (below + window_.size() < n) {
    above = 0;
    mark(above, scale);
    below = collect(view);
  }
  const std::size_t wanted = std::min<std::size_t>(n - below, window_.size());
  if (wanted > 0) std::nth_element(window_.begin(), window_.begin() + static_cast<std::ptrdiff_t>(wanted - 1), window_.end());
  out.scale = wanted > 0 ? window_[wanted - 1].key : above;
  for (const WindowPoint& point : std::span(window_).first(wanted)) {
    shown_[point.key_index / kWord] |= std::uint64_t{1} << point.key_index % kWord;
  }
  // With too few points, all that have a density are shown; deeper ones belong to the scale that there would be with enough.
  if (below + wanted < n) out.scale = std::max(measure_scale(view, n), out.scale);
  finish(view, below + wanted, out);
  while (below + wanted < n && out.lacking.empty() && !out.is_exhausted && any_lacking(view)) {
    out.scale *= kFaster;
    find_lacking(view, out);
  }
  out.tree = std::move(tree);
}

void RankSelector::densities(const RankSelection& selection, std::span<float> out) const {
  std::size_t i = 0;
  selection.for_each_shown([&](const RankRef& ref, std::size_t bit) {
    const RankChunk& chunk = selection.chunk(ref);
    out[i++] = to_key(chunk.rank[ref.point], static_cast<float>(chunk.id.rank_step()), keys_[bit]);
  });
}

std::size_t RankSelector::byte_size() const {
  const auto& [parallel, states, visited, most, keys, shown, bits, window, lacking] = *this;
  return capacity_bytes(states, visited, most, keys, shown, bits, window, lacking);
}

float RankSelector::guess_scale(const View& view, std::uint64_t n) {
  const RankChunk& first = *view.tree.chunks().front();
  float factor[kChunkStrata];
  evaluate(view, first, 0, first.size(), !first.beside.empty(), factor);
  double sum = 0;
  std::size_t counted = 0;
  for (const float f : std::span(factor).first(first.size())) {
    sum += static_cast<double>(f);
    counted += f > 0 ? 1 : 0;
  }
  constexpr std::size_t kEnough = 64;
  if (counted < kEnough) return 0;
  return static_cast<float>(static_cast<double>(n) * static_cast<double>(first.size()) / sum);
}

float RankSelector::measure_scale(const View& view, std::uint64_t n) const {
  double integral = 0;  // of the density, over parts of the whole area
  for (std::size_t v = 0; v < visited_.size(); ++v) {
    const RankChunk& chunk = *view.tree.chunks()[visited_[v].chunk];
    constexpr std::size_t kQuarter = kLayerStrata / 4;
    const auto step = static_cast<float>(chunk.id.rank_step());
    for (std::size_t q = 0; q < 4; ++q) {
      const float most = quarter_bound(v, q);
      if (most == 0 || view.tree.child(visited_[v].chunk, q) != RankTree::kNone) continue;
      double sum = 0;
      for (std::size_t layer = 0; layer < visited_[v].layers; ++layer) {
        const std::size_t first = layer * kLayerStrata + q * kQuarter;
        for (std::size_t i = first; i < first + kQuarter; ++i) {
          sum += static_cast<double>(to_key(chunk.rank[i], step, keys_[visited_[v].first_key + i]));
        }
      }
      // Where no point has a density the view may still show a part between them.
      sum = std::max(sum, 0.25 * static_cast<double>(most));
      integral +=
          sum / static_cast<double>(chunk.layers() * kQuarter) * std::ldexp(1.0, -2 * (chunk.id.level + 1 - kChunkLevels));
    }
  }
  return integral > 0 ? static_cast<float>(std::min(static_cast<double>(n) / integral, kMostScale)) : 0.0f;
}

float RankSelector::quarter_bound(std::size_t v, std::size_t quarter) const {
  const float* const most = &most_[v * kChunkRuns + kQuarterRuns * quarter];
  return *std::max_element(most, most + kQuarterRuns);
}

bool RankSelector::visit(const View& view, float scale) {
  const auto chunks = view.tree.chunks();
  states_.assign(chunks.size(), State::kWaits);
  states_[0] = State::kVisited;
  visited_.clear();
  most_.clear();
  bool is_all = true;
  std::size_t keys = 0;
  for (std::size_t c = 0; c < chunks.size(); ++c) {
    if (c + kAhead < chunks.size() && states_[c + kAhead] == State::kVisited) {
      prefetch(chunks[c + kAhead].get(), offsetof(RankChunk, used) + sizeof(LastUse));
      prefetch(&chunks[c + kAhead]->bounds, sizeof(RunBounds));
    }
    const auto decide_children = [&](const auto& state_of_quarter) {
      for (std::size_t q = 0; q < 4; ++q) {
        if (const std::uint32_t child = view.tree.child(c, q); child != RankTree::kNone) states_[child] = state_of_quarter(q);
      }
    };
    if (states_[c] == State::kWaits) {
      is_all = false;
    } else if (states_[c] == State::kEmpty) {
      decide_children([](std::size_t) { return State::kEmpty; });
    } else {
      const RankChunk& chunk = *chunks[c];
      chunk.used.set(view.tree.growth());
      float most[kChunkRuns];
      bound_runs(view, chunk, most);
      is_all = is_all && shows_all(chunk, most, scale);
      std::size_t layers = 0;
      const float most_of_all = *std::max_element(most, most + kChunkRuns);
      while (layers < chunk.layers() && !needs_none(chunk.id, most_of_all, scale, layers)) ++layers;
      visited_.push_back({static_cast<std::uint32_t>(c), keys, layers});
      most_.insert(most_.end(), most, most + kChunkRuns);
      keys += chunk.size();
      decide_children([&](std::size_t q) {
        const float in_quarter = *std::max_element(most + kQuarterRuns * q, most + kQuarterRuns * (q + 1));
        if (in_quarter == 0) return State::kEmpty;
        return needs_none(chunk.id.child(q), in_quarter, scale) ? State::kWaits : State::kVisited;
      });
    }
  }
  keys_.resize(keys);
  shown_.resize(keys / kWord);
  bits_.resize(keys / kWord);
  for_each_visited([&](std::size_t v, std::size_t end) {
    if (v + 1 < end) prefetch_runs(*chunks[visited_[v + 1].chunk], &most_[(v + 1) * kChunkRuns], scale);
    if (v + 2 < end) prefetch_columns(*chunks[visited_[v + 2].chunk]);
    fill_keys(view, *chunks[visited_[v].chunk], visited_[v].layers, &most_[v * kChunkRuns], scale, &keys_[visited_[v].first_key]);
    mark(v, kFewer * scale, scale);
  });
  return is_all;
}

template <typename Work>
void RankSelector::for_each_visited(const Work& work) {
  const auto some = [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t v = range.begin(); v < range.end(); ++v) work(v, range.end());
  };
  const tbb::blocked_range<std::size_t> all(0, visited_.size(), kGrain);
  if (is_parallel_) {
    tbb::parallel_for(all, some);
  } else {
    some(all);
  }
}

void RankSelector::bound_runs(const View& view, const RankChunk& chunk, float* most) {
  view.factor.most_of_blocks(chunk.bounds.columns(), kChunkRuns, most);
  if (view.factor.is_fixed_by_detail()) {
    for (std::size_t r = 0; r < kChunkRuns; ++r) most[r] *= chunk.bounds.detail[r];
    return;
  }
  if (view.density == nullptr) return;
  for (std::size_t r = 0; r < kChunkRuns; ++r) {
    const std::size_t first = chunk.first_vertex[r] / kBlockSize, last = chunk.last_vertex[r] / kBlockSize;
    const auto blocks = std::span<const float>(view.density->most).subspan(first, last - first + 1);
    most[r] *= *std::max_element(blocks.begin(), blocks.end());
  }
}

void RankSelector::fill_keys(const View& view, const RankChunk& chunk, std::size_t layers, const float* most, float scale,
                             float* keys) {
  float factor[kLayerStrata];
  const auto is_beside = [&](std::size_t r) { return (chunk.runs_beside >> r & 1) != 0; };
  for (std::size_t layer = 0; layer < layers; ++layer) {
    const std::size_t first = layer * kLayerStrata;
    for (std::size_t r = 0; r < kChunkRuns;) {
      // Neighbouring runs of one kind are done in one go.
      const bool is_none = needs_none(chunk.id, most[r], scale, layer);
      std::size_t next = r + 1;
      while (next < kChunkRuns && needs_none(chunk.id, most[next], scale, layer) == is_none &&
             (is_none || is_beside(next) == is_beside(r))) {
        ++next;
      }
      const std::size_t begin = first + r * kRunPoints, end = first + next * kRunPoints;
      if (is_none) {
        std::fill(keys + begin, keys + end, kInfinity);
      } else {
        evaluate(view, chunk, begin, end, is_beside(r), factor);
        to_keys(&chunk.rank[begin], static_cast<float>(chunk.id.rank_step()), factor, end - begin, keys + begin);
      }
      r = next;
    }
  }
}

void RankSelector::evaluate(const View& view, const RankChunk& chunk, std::size_t begin, std::size_t end, bool is_beside,
                            float* density) {
  const std::size_t n = end - begin;
  if (view.factor.is_fixed_by_detail()) {
    std::copy_n(&chunk.detail[begin], n, density);
  } else if (view.density == nullptr) {
    std::fill_n(density, n, 1.0f);
  } else {
    for (std::size_t i = 0; i < n; ++i) density[i] = view.density->density[chunk.vertex[begin + i]];
  }
  const VertexColumns vertices = {&chunk.x[begin],
                                  &chunk.y[begin],
                                  &chunk.z[begin],
                                  &chunk.nx[begin],
                                  &chunk.ny[begin],
                                  &chunk.nz[begin],
                                  is_beside ? &chunk.beside[begin] : nullptr};
  view.factor.multiply(vertices, n, density);
}

void RankSelector::mark(std::size_t v, float above, float upto) {
  const std::size_t end = v + 1 < visited_.size() ? visited_[v + 1].first_key : keys_.size();
  const std::size_t first = visited_[v].first_key, word = first / kWord, words = visited_[v].layers * kLayerStrata / kWord;
  visited_[v].below = mark_upto(&keys_[first], words, above, &shown_[word]);
  std::fill(&shown_[word] + words, shown_.data() + end / kWord, 0);
  mark_upto(&keys_[first], words, upto, &bits_[word]);
}

void RankSelector::mark(float above, float upto) {
  for_each_visited([&](std::size_t v, std::size_t) { mark(v, above, upto); });
}

std::size_t RankSelector::collect(const View& view) {
  window_.clear();
  std::size_t below = 0;
  for (const Visited& visited : visited_) {
    below += visited.below;
    const RankChunk& chunk = *view.tree.chunks()[visited.chunk];
    const std::size_t first = visited.first_key, end = first + visited.layers * kLayerStrata;
    for (std::size_t w = first / kWord; w < end / kWord; ++w) {
      for_each_bit(bits_[w] & ~shown_[w], w * kWord, [&](std::size_t i) {
        window_.push_back({keys_[i], chunk.rank_of(i - first), static_cast<std::uint32_t>(i)});
      });
    }
  }
  return below;
}

void RankSelector::finish(const View& view, std::size_t count, RankSelection& out) {
  const auto chunks = view.tree.chunks();
  out.count = count;
  out.shown.swap(shown_);
  out.rungs.clear();
  out.parts.clear();
  for (const Visited& visited : visited_) {
    out.parts.push_back({chunks[visited.chunk], static_cast<std::uint32_t>(visited.first_key), visited.chunk});
  }
  find_lacking(view, out);
}

void RankSelector::find_lacking(const View& view, RankSelection& out) {
  lacking_.clear();
  double most = 0;
  out.is_exhausted = false;
  for (std::size_t v = 0; v < visited_.size(); ++v) {
    const ChunkId& id = view.tree.chunks()[visited_[v].chunk]->id;
    for (std::size_t q = 0; q < 4; ++q) {
      if (view.tree.child(visited_[v].chunk, q) != RankTree::kNone) continue;
      const float bound = quarter_bound(v, q);
      if (needs_none(id.child(q), bound, out.scale)) continue;
      if (id.level == kMaxRankLevel) {
        out.is_exhausted = true;
      } else {
        const double excess = static_cast<double>(bound) / static_cast<double>(id.child(q).first_rank());
        lacking_.emplace_back(excess, id.child(q));
        most = std::max(most, excess);
      }
    }
  }
  out.lacking.clear();
  const auto add = [&](bool urgent) {
    for (const auto& [excess, id] : lacking_) {
      if ((excess >= kUrgent * most) == urgent) out.lacking.push_back(id);
    }
  };
  add(true);
  out.urgent = out.lacking.size();
  add(false);
}

bool RankSelector::any_lacking(const View& view) const {
  for (std::size_t v = 0; v < visited_.size(); ++v) {
    for (std::size_t q = 0; q < 4; ++q) {
      if (view.tree.child(visited_[v].chunk, q) == RankTree::kNone && quarter_bound(v, q) > 0) return true;
    }
  }
  return false;
}

}  // namespace curvecast
