#include "core/progressive/rank_selection.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "core/base/simd.h"

namespace curvecast {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kSlack = 1.0001f;  // bounds are rounded, points too
constexpr std::size_t kWord = RankSelection::kWord;

static_assert(kChunkStrata % (4 * kWord) == 0, "chunks fill whole words");

/// Writes the scales that points need: (rank + 1) / density.
CURVECAST_WIDE void to_keys(const std::uint32_t* __restrict rank, const float* __restrict density, std::size_t n,
                            float* __restrict key) {
  for (std::size_t i = 0; i < n; ++i) key[i] = static_cast<float>(static_cast<std::int32_t>(rank[i]) + 1) / density[i];
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

/// Says whether no point of the chunk, or of chunks below it, is shown at the scale where the density is at most `most`.
bool needs_none(const ChunkId& id, float most, float scale) {
  return static_cast<double>(most) * static_cast<double>(kSlack) * static_cast<double>(scale) <
         static_cast<double>(id.first_rank()) + 1;
}

}  // namespace

void RankSelector::select(std::shared_ptr<const RankTree> tree, const FixedDensity* density, const ViewFactor& factor,
                          std::uint64_t n, RankSelection& out) {
  const View view{*tree, density, factor};
  // Most frames are done in one go; a view of a small part of the surface cannot be guessed.
  constexpr float kMore = 1.05f, kFewer = 0.93f, kFaster = 4;
  const float guess = guess_scale(view, n);
  float scale = kMore * guess, above = 0;
  std::size_t below = 0;
  for (bool is_all = false;; scale *= kFaster) {
    is_all = visit(view, scale);
    above = kFewer * scale;
    below = collect(view, above, scale);
    if (below + window_.size() >= n) break;
    if (is_all) {
      scale = std::numeric_limits<float>::max();
      break;
    }
  }
  if (below >= n || below + window_.size() < n) {
    above = 0;
    below = collect(view, above, scale);
  }
  const std::size_t wanted = std::min<std::size_t>(n - below, window_.size());
  if (wanted > 0) std::nth_element(window_.begin(), window_.begin() + static_cast<std::ptrdiff_t>(wanted - 1), window_.end());
  out.scale = wanted > 0 ? window_[wanted - 1].key : above;
  if (below + wanted < n) out.scale = guess;  // what is lacking depends on it
  for (const WindowPoint& point : std::span(window_).first(wanted)) {
    shown_[point.key_index / kWord] |= std::uint64_t{1} << point.key_index % kWord;
  }
  finish(view, below + wanted, out);
  out.tree = std::move(tree);
}

void RankSelector::densities(const RankSelection& selection, std::span<float> out) const {
  std::size_t i = 0;
  selection.for_each_shown([&](const RankRef& ref, std::size_t bit) {
    const std::uint32_t rank = selection.tree->chunks()[ref.chunk]->rank[ref.point];
    out[i++] = static_cast<float>(static_cast<std::int32_t>(rank) + 1) / keys_[bit];
  });
}

std::size_t RankSelector::byte_size() const {
  const auto& [states, visited, most, keys, factor, shown, bits, window] = *this;
  return capacity_bytes(states, visited, most, keys, factor, shown, bits, window);
}

float RankSelector::guess_scale(const View& view, std::uint64_t n) {
  const RankChunk& first = *view.tree.chunks().front();
  keys_.resize(first.size());
  evaluate(view, first, 0, first.size(), keys_.data());
  double sum = 0;
  for (const float factor : std::span(factor_).first(first.size())) sum += static_cast<double>(factor);
  const double mean = sum / static_cast<double>(first.size());
  // Where none of so many points has a density the view may still show a part between them.
  const double guess = static_cast<double>(n) / std::max(mean, 1e-30);
  return static_cast<float>(std::min(guess, 1e30));
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
      float most[kChunkRuns];
      bound_runs(view, chunk, most);
      visited_.push_back({static_cast<std::uint32_t>(c), keys});
      most_.insert(most_.end(), most, most + kChunkRuns);
      keys_.resize(std::max(keys_.size(), keys + chunk.size()));
      is_all = fill_keys(view, chunk, most, scale, &keys_[keys]) && is_all;
      keys += chunk.size();
      decide_children([&](std::size_t q) {
        const float in_quarter = *std::max_element(most + 4 * q, most + 4 * q + 4);
        if (in_quarter == 0) return State::kEmpty;
        return needs_none(chunk.id.child(q), in_quarter, scale) ? State::kWaits : State::kVisited;
      });
    }
  }
  keys_.resize(keys);
  return is_all;
}

void RankSelector::bound_runs(const View& view, const RankChunk& chunk, float* most) {
  view.factor.most_of_blocks(chunk.bounds, 0, kChunkRuns, most);
  if (view.density == nullptr) return;
  for (std::size_t r = 0; r < kChunkRuns; ++r) {
    const std::size_t first = chunk.first_vertex[r] / kBlockSize, last = chunk.last_vertex[r] / kBlockSize;
    const auto blocks = std::span<const float>(view.density->most).subspan(first, last - first + 1);
    most[r] *= *std::max_element(blocks.begin(), blocks.end());
  }
}

bool RankSelector::fill_keys(const View& view, const RankChunk& chunk, const float* most, float scale, float* keys) {
  const std::size_t length = chunk.run_size();
  bool is_all = true;
  for (std::size_t r = 0; r < kChunkRuns;) {
    // Neighbouring runs of one kind are done in one go.
    const bool is_none = needs_none(chunk.id, most[r], scale);
    std::size_t end = r + 1;
    while (end < kChunkRuns && needs_none(chunk.id, most[end], scale) == is_none) ++end;
    if (is_none) {
      std::fill(keys + r * length, keys + end * length, kInfinity);
      is_all = is_all && std::all_of(most + r, most + end, [](float m) { return m == 0; });
    } else {
      evaluate(view, chunk, r * length, end * length, keys + r * length);
    }
    r = end;
  }
  return is_all;
}

void RankSelector::evaluate(const View& view, const RankChunk& chunk, std::size_t begin, std::size_t end, float* keys) {
  const std::size_t n = end - begin;
  if (factor_.size() < n) factor_.resize(n);
  float* const factor = factor_.data();
  if (view.density == nullptr) {
    std::fill_n(factor, n, 1.0f);
  } else {
    for (std::size_t i = 0; i < n; ++i) factor[i] = view.density->density[chunk.vertex[begin + i]];
  }
  view.factor.multiply(&chunk.x[begin], &chunk.y[begin], &chunk.z[begin], &chunk.nx[begin], &chunk.ny[begin], &chunk.nz[begin], n,
                       factor);
  to_keys(&chunk.rank[begin], factor, n, keys);
}

std::size_t RankSelector::collect(const View& view, float above, float upto) {
  window_.clear();
  const std::size_t words = keys_.size() / kWord;
  shown_.resize(words);
  bits_.resize(words);
  const std::size_t below = mark_upto(keys_.data(), words, above, shown_.data());
  if (mark_upto(keys_.data(), words, upto, bits_.data()) == below) return below;
  std::size_t visited = 0;
  for (std::size_t w = 0; w < words; ++w) {
    while (visited + 1 < visited_.size() && visited_[visited + 1].first_key <= w * kWord) ++visited;
    const std::vector<std::uint32_t>& rank = view.tree.chunks()[visited_[visited].chunk]->rank;
    for (std::uint64_t bits = bits_[w] & ~shown_[w]; bits != 0; bits &= bits - 1) {
      const std::size_t i = w * kWord + static_cast<std::size_t>(std::countr_zero(bits));
      window_.push_back({keys_[i], rank[i - visited_[visited].first_key], static_cast<std::uint32_t>(i)});
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
  out.lacking.clear();
  out.is_exhausted = false;
  for (std::size_t v = 0; v < visited_.size(); ++v) {
    out.parts.push_back({visited_[v].chunk, static_cast<std::uint32_t>(visited_[v].first_key)});
    const ChunkId& id = chunks[visited_[v].chunk]->id;
    for (std::size_t q = 0; q < 4; ++q) {
      if (view.tree.child(visited_[v].chunk, q) != RankTree::kNone) continue;
      const float* const most = &most_[v * kChunkRuns + 4 * q];
      if (needs_none(id.child(q), *std::max_element(most, most + 4), out.scale)) continue;
      if (id.level == view.tree.deepest()) {
        out.is_exhausted = true;
      } else {
        out.lacking.push_back(id.child(q));
      }
    }
  }
}

}  // namespace curvecast
