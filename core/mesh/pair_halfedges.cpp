#include "core/mesh/pair_halfedges.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/mesh/triangle_mesh.h"

namespace curvecast {
namespace {

/// Drops faces with the same three vertices as an earlier one; returns how many there were.
std::uint64_t drop_duplicates(FaceList& faces) {
  std::vector<std::pair<Triangle, std::uint32_t>> sorted(faces.triangles.size());
  for (std::uint32_t f = 0; f < sorted.size(); ++f) {
    Triangle key = faces.triangles[f];
    std::sort(key.begin(), key.end());
    sorted[f] = {key, f};
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<bool> drop(sorted.size(), false);
  std::uint64_t dropped = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i].first == sorted[i - 1].first) {
      drop[sorted[i].second] = true;
      ++dropped;
    }
  }
  if (dropped == 0) return 0;
  std::size_t kept = 0;
  for (std::size_t f = 0; f < drop.size(); ++f) {
    if (!drop[f]) faces.move(f, kept++);
  }
  faces.resize(kept);
  return dropped;
}

/// More than two faces at an edge, or two that share their third vertex too: there may be duplicates.
bool may_have_duplicates(const EdgeGroups& groups, const std::vector<Triangle>& triangles) {
  const auto apex = [&](std::uint32_t h) { return triangles[h / 3][previous_halfedge(h) % 3]; };
  for (std::size_t e = 0; e + 1 < groups.begin.size(); ++e) {
    const std::uint32_t size = groups.begin[e + 1] - groups.begin[e];
    const std::uint32_t* edge = &groups.halfedges[groups.begin[e]];
    if (size > 2 || (size == 2 && apex(edge[0]) == apex(edge[1]))) return true;
  }
  return false;
}

}  // namespace

EdgeGroups group_edges(const std::vector<Triangle>& triangles, std::size_t vertex_count) {
  struct Entry {
    std::uint32_t larger, halfedge;
  };
  const auto smaller_of = [&](std::uint32_t h) { return std::min(triangles[h / 3][h % 3], triangles[h / 3][(h + 1) % 3]); };
  const std::uint32_t count = static_cast<std::uint32_t>(3 * triangles.size());
  std::vector<std::uint32_t> bucket(vertex_count + 1, 0);
  for (std::uint32_t h = 0; h < count; ++h) ++bucket[smaller_of(h) + 1];
  std::partial_sum(bucket.begin(), bucket.end(), bucket.begin());
  std::vector<Entry> entries(count);
  std::vector<std::uint32_t> cursor(bucket.begin(), bucket.end() - 1);
  for (std::uint32_t h = 0; h < count; ++h) {
    const std::uint32_t larger = std::max(triangles[h / 3][h % 3], triangles[h / 3][(h + 1) % 3]);
    entries[cursor[smaller_of(h)]++] = {larger, h};
  }
  EdgeGroups groups;
  groups.halfedges.resize(count);
  groups.begin.reserve(count / 2 + 2);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    const auto first = entries.begin() + bucket[v];
    const auto last = entries.begin() + bucket[v + 1];
    std::sort(first, last, [](const Entry& a, const Entry& b) {
      return a.larger != b.larger ? a.larger < b.larger : a.halfedge < b.halfedge;
    });
    for (auto e = first; e != last; ++e) {
      if (e == first || e->larger != (e - 1)->larger) {
        groups.begin.push_back(static_cast<std::uint32_t>(e - entries.begin()));
      }
      groups.halfedges[e - entries.begin()] = e->halfedge;
    }
  }
  groups.begin.push_back(count);
  return groups;
}

std::vector<std::uint32_t> border_vertices(const EdgeGroups& groups, const std::vector<Triangle>& triangles,
                                           std::size_t vertex_count) {
  std::vector<bool> on_border;
  for (std::size_t e = 0; e + 1 < groups.begin.size(); ++e) {
    if (groups.begin[e + 1] - groups.begin[e] != 1) continue;
    if (on_border.empty()) on_border.resize(vertex_count, false);
    const std::uint32_t h = groups.halfedges[groups.begin[e]];
    on_border[triangles[h / 3][h % 3]] = true;
    on_border[triangles[h / 3][(h + 1) % 3]] = true;
  }
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < on_border.size(); ++v) {
    if (on_border[v]) vertices.push_back(v);
  }
  return vertices;
}

HalfedgePairs pair_halfedges(FaceList& faces, EdgeGroups groups, std::size_t vertex_count) {
  HalfedgePairs pairs;
  if (may_have_duplicates(groups, faces.triangles)) pairs.duplicate_faces = drop_duplicates(faces);
  if (pairs.duplicate_faces > 0) groups = group_edges(faces.triangles, vertex_count);
  pairs.twins.assign(3 * faces.triangles.size(), kNone);
  for (std::size_t e = 0; e + 1 < groups.begin.size(); ++e) {
    const std::uint32_t size = groups.begin[e + 1] - groups.begin[e];
    if (size == 2) {
      const std::uint32_t a = groups.halfedges[groups.begin[e]];
      const std::uint32_t b = groups.halfedges[groups.begin[e] + 1];
      pairs.twins[a] = b;
      pairs.twins[b] = a;
    } else if (size > 2) {
      ++pairs.nonmanifold_edges;
    }
  }
  return pairs;
}

}  // namespace curvecast
