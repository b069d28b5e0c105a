#include "core/mesh/pair_halfedges.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <span>
#include <utility>

#include "core/base/for_all.h"
#include "core/base/hash_buckets.h"
#include "core/base/random.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {
namespace {

constexpr std::size_t kBlock = 1 << 15;  // vertices or faces that a thread takes at once

/// What is found at the edges of some vertices.
struct Found {
  std::vector<std::uint32_t> border;
  std::uint64_t nonmanifold_edges = 0;
  bool is_oriented = true;
  bool may_have_duplicates = false;
};

class Pairing {
 public:
  Pairing(const std::vector<Triangle>& triangles, std::size_t vertex_count, const ExecutionContext& context)
      : triangles_(triangles), context_(context), first_(vertex_count + 1, 0), halfedges_(3 * triangles.size()) {}

  HalfedgePairs run() {
    HalfedgePairs pairs;
    sort_by_vertex();
    if (context_.cancelled()) return pairs;
    pairs.twins.assign(halfedges_.size(), kNone);
    const std::size_t vertices = first_.size() - 1;
    std::vector<Found> found((vertices + kBlock - 1) / kBlock);
    for_blocks(context_, vertices, kBlock,
               [&](std::size_t begin, std::size_t end) { pair(begin, end, pairs.twins, found[begin / kBlock]); });
    for (const Found& some : found) {
      pairs.border.insert(pairs.border.end(), some.border.begin(), some.border.end());
      pairs.nonmanifold_edges += some.nonmanifold_edges;
      pairs.is_oriented &= some.is_oriented;
      pairs.may_have_duplicates |= some.may_have_duplicates;
    }
    std::sort(pairs.border.begin(), pairs.border.end());
    return pairs;
  }

 private:
  struct Edge {
    std::uint32_t larger, halfedge;  // its larger vertex
    bool operator<(const Edge& other) const { return larger != other.larger ? larger < other.larger : halfedge < other.halfedge; }
  };

  std::uint32_t from(std::uint32_t h) const { return triangles_[h / 3][h % 3]; }
  std::uint32_t to(std::uint32_t h) const { return triangles_[h / 3][(h + 1) % 3]; }
  std::uint32_t apex(std::uint32_t h) const { return triangles_[h / 3][(h + 2) % 3]; }

  template <typename Visit>
  void for_each_halfedge(const Visit& visit) const {
    for_blocks(context_, triangles_.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) {
        for (std::size_t i = 0; i < 3; ++i) visit(static_cast<std::uint32_t>(3 * f + i));
      }
    });
  }

  /// Sorts all halfedges by the smaller of their vertices: those of v are [first_[v], first_[v + 1]) then.
  void sort_by_vertex() {
    const auto cursor = [&](std::uint32_t h) { return std::atomic_ref(first_[std::min(from(h), to(h))]); };
    for_each_halfedge([&](std::uint32_t h) { cursor(h).fetch_add(1, std::memory_order_relaxed); });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    for_each_halfedge([&](std::uint32_t h) { halfedges_[cursor(h).fetch_sub(1, std::memory_order_relaxed) - 1] = h; });
  }

  void pair(std::size_t begin, std::size_t end, std::vector<std::uint32_t>& twins, Found& found) const {
    std::vector<Edge> edges;  // of a vertex, to larger ones
    for (std::size_t v = begin; v < end; ++v) {
      edges.clear();
      for (std::uint32_t i = first_[v]; i < first_[v + 1]; ++i) {
        edges.push_back({std::max(from(halfedges_[i]), to(halfedges_[i])), halfedges_[i]});
      }
      std::sort(edges.begin(), edges.end());  // threads came in any order
      for (auto first = edges.begin(); first != edges.end();) {
        const auto last = std::find_if(first, edges.end(), [&](const Edge& edge) { return edge.larger != first->larger; });
        const std::uint32_t a = first->halfedge, b = (last - 1)->halfedge;
        if (last - first == 1) {
          found.border.push_back(a);
        } else if (last - first == 2) {
          twins[a] = b, twins[b] = a;
          found.is_oriented &= from(a) != from(b);
          found.may_have_duplicates |= apex(a) == apex(b);
        } else {
          ++found.nonmanifold_edges;
          found.may_have_duplicates = true;
        }
        first = last;
      }
    }
  }

  const std::vector<Triangle>& triangles_;
  const ExecutionContext& context_;
  std::vector<std::uint32_t> first_;  // of each vertex; until all are sorted the end of those that have not come yet
  std::vector<std::uint32_t> halfedges_;
};

}  // namespace

HalfedgePairs pair_halfedges(const std::vector<Triangle>& triangles, std::size_t vertex_count, const ExecutionContext& context) {
  return Pairing(triangles, vertex_count, context).run();
}

std::uint64_t drop_duplicates(FaceList& faces, const ExecutionContext& context) {
  const auto key_of = [&](std::size_t f) {
    Triangle key = faces.triangles[f];
    std::sort(key.begin(), key.end());
    return key;
  };
  const auto hash_of = [&](std::size_t f) {
    const Triangle key = key_of(f);
    return mix_bits(mix_bits(std::uint64_t{key[0]} << 32 | key[1]) + key[2]);
  };
  std::vector<std::uint8_t> drop(faces.triangles.size(), 0);
  for_each_bucket(context, drop.size(), hash_of, [&](std::span<const std::uint32_t> bucket) {
    std::vector<std::pair<Triangle, std::uint32_t>> sorted;
    sorted.reserve(bucket.size());
    for (const std::uint32_t f : bucket) sorted.emplace_back(key_of(f), f);
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t i = 1; i < sorted.size(); ++i) drop[sorted[i].second] = sorted[i].first == sorted[i - 1].first;
  });
  const auto dropped = static_cast<std::uint64_t>(std::count(drop.begin(), drop.end(), std::uint8_t{1}));
  if (dropped == 0) return 0;
  std::size_t kept = 0;
  for (std::size_t f = 0; f < drop.size(); ++f) {
    if (drop[f] == 0) faces.move(f, kept++);
  }
  faces.resize(kept);
  return dropped;
}

}  // namespace curvecast
