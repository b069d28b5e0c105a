#include "core/mesh/repair.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <numeric>

#include "core/mesh/topology.h"
#include "core/mesh/triangulate_polygon.h"

namespace curvecast {
namespace {

// Lengths whose squares and areas stay within a float's range, with room to spare.
constexpr double kSmallestDiagonal = 1e-12;
constexpr double kLargestDiagonal = 1e15;
// A triangle lower than this fraction of its longest side has no area to speak of.
constexpr double kDegenerateHeight = 1e-12;

/// For each vertex the first one at the same place.
std::vector<std::uint32_t> weld_map(const std::vector<Vec3d>& positions, std::uint64_t& welded) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    const Vec3d &p = positions[a], &q = positions[b];
    if (p.x() != q.x()) return p.x() < q.x();
    if (p.y() != q.y()) return p.y() < q.y();
    if (p.z() != q.z()) return p.z() < q.z();
    return a < b;
  };
  std::sort(order.begin(), order.end(), less);
  std::vector<std::uint32_t> map(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && positions[order[i]] == positions[order[i - 1]];
    map[order[i]] = same ? map[order[i - 1]] : order[i];
    welded += same;
  }
  return map;
}

bool is_degenerate(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return !((b - a).cross(c - a).norm() > kDegenerateHeight * longest);
}

std::vector<Triangle> triangulate(const PolygonSoup& soup, const std::vector<std::uint32_t>& weld, RepairReport& report) {
  std::vector<Triangle> triangles;
  triangles.reserve(soup.indices.size() > 2 * soup.polygon_count() ? soup.indices.size() - 2 * soup.polygon_count() : 0);
  std::vector<std::uint32_t> corners;
  std::vector<Vec3d> places;
  std::vector<Triangle> pieces;
  for (std::size_t p = 0; p < soup.polygon_count(); ++p) {
    corners.clear();
    for (std::uint32_t i = soup.polygon_begin[p]; i < soup.polygon_begin[p + 1]; ++i) {
      const std::uint32_t v = weld.empty() ? soup.indices[i] : weld[soup.indices[i]];
      if (corners.empty() || corners.back() != v) corners.push_back(v);
    }
    while (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
    if (corners.size() < 3) {
      ++report.degenerate_faces;
      continue;
    }
    pieces.clear();
    if (corners.size() == 3) {
      pieces.push_back({0, 1, 2});
    } else {
      ++report.triangulated_polygons;
      places.clear();
      for (const std::uint32_t v : corners) places.push_back(soup.positions[v]);
      triangulate_polygon(places, pieces);
    }
    for (const Triangle& t : pieces) {
      const Triangle face = {corners[t[0]], corners[t[1]], corners[t[2]]};
      const bool distinct = face[0] != face[1] && face[1] != face[2] && face[2] != face[0];
      if (!distinct || is_degenerate(soup.positions[face[0]], soup.positions[face[1]], soup.positions[face[2]])) {
        ++report.degenerate_faces;
      } else {
        triangles.push_back(face);
      }
    }
  }
  return triangles;
}

/// Halfedges sorted by the vertex pair that they join, as groups.
struct EdgeGroups {
  std::vector<std::uint32_t> halfedges;
  std::vector<std::uint32_t> begin;  // E + 1
};

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

/// Drops faces with the same three vertices as an earlier one. Returns whether there were any.
bool drop_duplicates(std::vector<Triangle>& triangles, RepairReport& report) {
  std::vector<std::pair<Triangle, std::uint32_t>> sorted(triangles.size());
  for (std::uint32_t f = 0; f < triangles.size(); ++f) {
    Triangle key = triangles[f];
    std::sort(key.begin(), key.end());
    sorted[f] = {key, f};
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<bool> drop(triangles.size(), false);
  std::uint64_t dropped = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i].first == sorted[i - 1].first) {
      drop[sorted[i].second] = true;
      ++dropped;
    }
  }
  if (dropped == 0) return false;
  std::size_t kept = 0;
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    if (!drop[f]) triangles[kept++] = triangles[f];
  }
  triangles.resize(kept);
  report.duplicate_faces += dropped;
  return true;
}

/// Twins of all edges with exactly two faces; edges with more stay open and are counted.
std::vector<std::uint32_t> pair_halfedges(std::vector<Triangle>& triangles, std::size_t vertex_count, RepairReport& report) {
  EdgeGroups groups = group_edges(triangles, vertex_count);
  // More than two faces at an edge, or two that share their third vertex too: there may be duplicates.
  const auto apex = [&](std::uint32_t h) { return triangles[h / 3][previous_halfedge(h) % 3]; };
  const auto suspicious = [&] {
    for (std::size_t e = 0; e + 1 < groups.begin.size(); ++e) {
      const std::uint32_t size = groups.begin[e + 1] - groups.begin[e];
      const std::uint32_t* edge = &groups.halfedges[groups.begin[e]];
      if (size > 2 || (size == 2 && apex(edge[0]) == apex(edge[1]))) return true;
    }
    return false;
  };
  if (suspicious() && drop_duplicates(triangles, report)) groups = group_edges(triangles, vertex_count);
  std::vector<std::uint32_t> twins(3 * triangles.size(), kNone);
  for (std::size_t e = 0; e + 1 < groups.begin.size(); ++e) {
    const std::uint32_t size = groups.begin[e + 1] - groups.begin[e];
    if (size == 2) {
      const std::uint32_t a = groups.halfedges[groups.begin[e]];
      const std::uint32_t b = groups.halfedges[groups.begin[e] + 1];
      twins[a] = b;
      twins[b] = a;
    } else if (size > 2) {
      ++report.nonmanifold_edges;
    }
  }
  return twins;
}

/// Decides which faces to turn so that neighbours agree; opens the edges of surfaces that have one side only.
std::vector<char> find_flips(const std::vector<Triangle>& triangles, std::vector<std::uint32_t>& twins, RepairReport& report) {
  constexpr char kUnseen = 2;
  std::vector<char> flip(triangles.size(), kUnseen);
  std::vector<std::uint32_t> component;
  const auto from = [&](std::uint32_t h) { return triangles[h / 3][h % 3]; };
  for (std::uint32_t seed = 0; seed < triangles.size(); ++seed) {
    if (flip[seed] != kUnseen) continue;
    component.assign(1, seed);
    flip[seed] = 0;
    std::size_t turned = 0;
    for (std::size_t i = 0; i < component.size(); ++i) {
      const std::uint32_t f = component[i];
      for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
        const std::uint32_t t = twins[h];
        if (t == kNone) continue;
        const char wanted = static_cast<char>(flip[f] ^ (from(h) == from(t)));
        char& other = flip[t / 3];
        if (other == kUnseen) {
          other = wanted;
          turned += wanted;
          component.push_back(t / 3);
        } else if (other != wanted) {
          twins[h] = twins[t] = kNone;
          ++report.nonmanifold_edges;
        }
      }
    }
    // The majority of the file's faces keeps its orientation.
    const bool invert = 2 * turned > component.size();
    for (const std::uint32_t f : component) {
      flip[f] = static_cast<char>(flip[f] ^ invert);
      report.flipped_faces += flip[f];
    }
  }
  return flip;
}

void apply_flips(const std::vector<char>& flip, std::vector<Triangle>& triangles, std::vector<std::uint32_t>& twins) {
  // Turning (a, b, c) into (a, c, b) makes halfedge 0 the new 2 and the other way round.
  const auto renamed = [&](std::uint32_t h) { return flip[h / 3] ? 3 * (h / 3) + 2 - h % 3 : h; };
  std::vector<std::uint32_t> moved(twins.size());
  for (std::uint32_t h = 0; h < twins.size(); ++h) moved[renamed(h)] = twins[h] == kNone ? kNone : renamed(twins[h]);
  twins = std::move(moved);
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    if (flip[f]) std::swap(triangles[f][1], triangles[f][2]);
  }
}

/// Gives every fan of faces around a vertex a vertex of its own, numbered by first use.
TriangleMesh split_into_fans(const std::vector<Vec3d>& positions, const std::vector<Triangle>& triangles,
                             std::vector<std::uint32_t> twins, RepairReport& report) {
  TriangleMesh mesh;
  std::vector<std::uint32_t> fan_of_corner;
  const std::uint32_t fans = label_fans(twins, fan_of_corner);
  mesh.twins = std::move(twins);
  mesh.positions.resize(fans);
  mesh.triangles.resize(triangles.size());
  std::vector<bool> used(positions.size(), false);
  for (std::uint32_t h = 0; h < fan_of_corner.size(); ++h) {
    const std::uint32_t v = triangles[h / 3][h % 3];
    mesh.triangles[h / 3][h % 3] = fan_of_corner[h];
    mesh.positions[fan_of_corner[h]] = positions[v];
    used[v] = true;
  }
  const auto used_count = static_cast<std::uint64_t>(std::count(used.begin(), used.end(), true));
  report.unused_vertices = positions.size() - used_count;
  report.split_vertices = fans - used_count;
  return mesh;
}

}  // namespace

absl::StatusOr<RepairedMesh> repair(const PolygonSoup& soup, const ExecutionContext& context) {
  RepairedMesh result;
  RepairReport& report = result.report;
  context.progress("repair", 0);
  std::vector<std::uint32_t> weld;
  if (!soup.shares_vertices) weld = weld_map(soup.positions, report.welded_vertices);
  std::vector<Triangle> triangles = triangulate(soup, weld, report);
  if (triangles.empty()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("the mesh has no face with an area (all %d are degenerate)", soup.polygon_count()));
  }
  if (absl::Status status = context.check(); !status.ok()) return status;
  context.progress("repair", 0.3);
  std::vector<std::uint32_t> twins = pair_halfedges(triangles, soup.positions.size(), report);
  const std::vector<char> flip = find_flips(triangles, twins, report);
  if (report.flipped_faces > 0) apply_flips(flip, triangles, twins);
  context.progress("repair", 0.8);
  result.mesh = split_into_fans(soup.positions, triangles, std::move(twins), report);
  report.unused_vertices -= report.welded_vertices;
  const double diagonal = bounding_box(result.mesh).diagonal();
  if (!(diagonal >= kSmallestDiagonal && diagonal <= kLargestDiagonal)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("the mesh's bounding box has a diagonal of %g; between %g and %g are possible: scale the mesh", diagonal,
                        kSmallestDiagonal, kLargestDiagonal));
  }
  context.progress("repair", 1);
  return result;
}

}  // namespace curvecast
