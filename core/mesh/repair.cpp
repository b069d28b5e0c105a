#include "core/mesh/repair.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "core/base/for_all.h"
#include "core/mesh/carry_attributes.h"
#include "core/mesh/face_list.h"
#include "core/mesh/pair_halfedges.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangulate_polygon.h"
#include "core/mesh/weld.h"

namespace curvecast {
namespace {

// Lengths whose squares and areas stay within a float's range, with room to spare.
constexpr double kSmallestDiagonal = 1e-12;
constexpr double kLargestDiagonal = 1e15;
// A triangle lower than this fraction of its longest side has no area to speak of.
constexpr double kDegenerateHeight = 1e-12;
constexpr std::size_t kBlock = 1 << 15;   // faces that a thread takes at once
constexpr std::size_t kInTurn = 1 << 18;  // faces or corners between two looks whether the work was cancelled

bool is_degenerate(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return !((b - a).cross(c - a).norm() > kDegenerateHeight * longest);
}

/// Faces of some polygons, and what became of the others.
struct Triangulated {
  FaceList faces;
  std::uint64_t triangulated_polygons = 0, degenerate_faces = 0;
  bool one_each = true;  // face i is polygon begin + i, and `faces` does not say it
};

/// Makes faces of the polygons [begin, end). Which corners a face comes from is noted where the soup has something that hangs on
/// them, and which polygon from the first on that is not one face.
Triangulated triangulate(const PolygonSoup& soup, const std::vector<std::uint32_t>& weld_map, std::size_t begin,
                         std::size_t end) {
  const bool wants_corners = !soup.attributes.uv.empty();
  Triangulated out;
  FaceList& faces = out.faces;
  const std::size_t corner_count = soup.polygon_begin[end] - soup.polygon_begin[begin];
  faces.triangles.reserve(corner_count - std::min(corner_count, 2 * (end - begin)));
  std::vector<std::uint32_t> vertices;
  std::vector<std::uint32_t> corners;  // of the soup, like `vertices`
  std::vector<Vec3d> places;
  std::vector<Triangle> pieces;
  bool one_each = true;  // so far
  const auto note = [&](std::size_t p) {
    if (one_each && faces.triangles.size() == p + 1 - begin) return;
    if (one_each) {
      faces.polygons.resize(p - begin);
      std::iota(faces.polygons.begin(), faces.polygons.end(), static_cast<std::uint32_t>(begin));
      one_each = false;
    }
    faces.polygons.resize(faces.triangles.size(), static_cast<std::uint32_t>(p));
  };
  for (std::size_t p = begin; p < end; ++p) {
    vertices.clear();
    corners.clear();
    for (std::uint32_t i = soup.polygon_begin[p]; i < soup.polygon_begin[p + 1]; ++i) {
      const std::uint32_t v = weld_map.empty() ? soup.indices[i] : weld_map[soup.indices[i]];
      if (!vertices.empty() && vertices.back() == v) continue;
      vertices.push_back(v);
      corners.push_back(i);
    }
    while (vertices.size() > 1 && vertices.front() == vertices.back()) vertices.pop_back();
    if (vertices.size() < 3) {
      ++out.degenerate_faces;
      note(p);
      continue;
    }
    pieces.clear();
    if (vertices.size() == 3) {
      pieces.push_back({0, 1, 2});
    } else {
      ++out.triangulated_polygons;
      places.clear();
      for (const std::uint32_t v : vertices) places.push_back(soup.positions[v]);
      triangulate_polygon(places, pieces);
    }
    for (const Triangle& t : pieces) {
      const Triangle face = {vertices[t[0]], vertices[t[1]], vertices[t[2]]};
      const bool distinct = face[0] != face[1] && face[1] != face[2] && face[2] != face[0];
      if (!distinct || is_degenerate(soup.positions[face[0]], soup.positions[face[1]], soup.positions[face[2]])) {
        ++out.degenerate_faces;
        continue;
      }
      faces.triangles.push_back(face);
      if (wants_corners) faces.corners.insert(faces.corners.end(), {corners[t[0]], corners[t[1]], corners[t[2]]});
    }
    note(p);
  }
  out.one_each = one_each;
  return out;
}

FaceList triangulate_all(const PolygonSoup& soup, const std::vector<std::uint32_t>& weld_map, const ExecutionContext& context,
                         RepairReport& report) {
  const std::size_t polygons = soup.polygon_count();
  std::vector<Triangulated> blocks((polygons + kBlock - 1) / kBlock);
  for_blocks(context, polygons, kBlock,
             [&](std::size_t begin, std::size_t end) { blocks[begin / kBlock] = triangulate(soup, weld_map, begin, end); });
  std::size_t count = 0;
  bool one_each = true;
  for (const Triangulated& block : blocks) {
    count += block.faces.triangles.size();
    one_each = one_each && block.one_each;
    report.triangulated_polygons += block.triangulated_polygons;
    report.degenerate_faces += block.degenerate_faces;
  }
  FaceList faces;
  faces.triangles.reserve(count);
  for_blocks_in_turn(context, blocks.size(), 1, [&](std::size_t b, std::size_t /*end*/) {
    FaceList& more = blocks[b].faces;
    if (!one_each && blocks[b].one_each) {
      more.polygons.resize(more.triangles.size());
      std::iota(more.polygons.begin(), more.polygons.end(), static_cast<std::uint32_t>(b * kBlock));
    }
    faces.append(more);
    blocks[b] = {};
  });
  return faces;
}

/// Joins surfaces that touch along borders but have vertices of their own there, as files do that cut along texture seams or
/// share no vertices at all. What is closed already is left alone, whatever it touches. Empty where nothing is joined.
std::vector<std::uint32_t> weld_borders(const std::vector<Vec3d>& positions, std::span<const std::uint32_t> border,
                                        const ExecutionContext& context, FaceList& faces, RepairReport& report) {
  if (border.empty()) return {};
  std::vector<bool> on_border(positions.size(), false);
  for (const std::uint32_t h : border) {
    on_border[faces.triangles[h / 3][h % 3]] = on_border[faces.triangles[h / 3][(h + 1) % 3]] = true;
  }
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < on_border.size(); ++v) {
    if (on_border[v]) vertices.push_back(v);
  }
  Weld welding = weld(positions, vertices, context);
  if (welding.welded == 0) return {};
  report.welded_vertices = welding.welded;
  for_blocks(context, faces.triangles.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      for (std::uint32_t& v : faces.triangles[f]) v = welding.map[v];
    }
  });
  return std::move(welding.map);
}

/// Decides which faces to turn so that neighbours agree; opens the edges of surfaces that have one side only.
std::vector<char> find_flips(const std::vector<Triangle>& triangles, std::vector<std::uint32_t>& twins,
                             const ExecutionContext& context, RepairReport& report) {
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
      if (i % kInTurn == 0 && context.cancelled()) return flip;
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

FaceSources sources_of(const FaceList& faces, const std::vector<char>& flip, const ExecutionContext& context) {
  const bool any_turned = std::any_of(flip.begin(), flip.end(), [](char turned) { return turned != 0; });
  if (faces.polygons.empty() && !any_turned) return {};
  Column<std::uint32_t> codes;
  codes.resize(faces.triangles.size());
  for_blocks(context, codes.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const std::uint32_t polygon = faces.polygons.empty() ? static_cast<std::uint32_t>(f) : faces.polygons[f];
      codes[f] = FaceSources::code(polygon, !flip.empty() && flip[f] != 0);
    }
  });
  return FaceSources(std::move(codes));
}

void apply_flips(const std::vector<char>& flip, const ExecutionContext& context, FaceList& faces,
                 std::vector<std::uint32_t>& twins) {
  // Turning (a, b, c) into (a, c, b) makes halfedge 0 the new 2 and the other way round.
  const auto renamed = [&](std::uint32_t h) { return flip[h / 3] ? 3 * (h / 3) + 2 - h % 3 : h; };
  std::vector<std::uint32_t> moved(twins.size());
  for_blocks(context, flip.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (auto h = static_cast<std::uint32_t>(3 * begin); h < 3 * end; ++h) {
      moved[renamed(h)] = twins[h] == kNone ? kNone : renamed(twins[h]);
    }
    for (std::size_t f = begin; f < end; ++f) {
      if (flip[f]) faces.flip(f);
    }
  });
  twins = std::move(moved);
}

/// Gives every fan of faces around a vertex a vertex of its own, numbered by first use; `source` tells whose it was.
absl::StatusOr<TriangleMesh> split_into_fans(const std::vector<Vec3d>& positions, std::vector<Triangle> triangles,
                                             std::vector<std::uint32_t> twins, const ExecutionContext& context,
                                             std::vector<std::uint32_t>& source, RepairReport& report) {
  std::vector<std::uint32_t> fan_of_corner;
  const std::uint32_t fans = label_fans(twins, fan_of_corner, context);
  if (absl::Status status = context.check(); !status.ok()) return status;
  source.resize(fans);
  std::vector<bool> used(positions.size(), false);
  for_blocks_in_turn(context, fan_of_corner.size(), kInTurn, [&](std::size_t begin, std::size_t end) {
    for (std::size_t h = begin; h < end; ++h) {
      std::uint32_t& v = triangles[h / 3][h % 3];
      used[v] = true;
      source[fan_of_corner[h]] = v;
      v = fan_of_corner[h];
    }
  });
  if (absl::Status status = context.check(); !status.ok()) return status;
  const auto used_count = static_cast<std::uint64_t>(std::count(used.begin(), used.end(), true));
  report.unused_vertices = positions.size() - used_count;
  report.split_vertices = fans - used_count;
  TriangleMesh mesh{{}, std::move(triangles), std::move(twins)};
  mesh.positions.resize(fans);
  for_blocks(context, fans, kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t fan = begin; fan < end; ++fan) mesh.positions[fan] = positions[source[fan]];
  });
  if (absl::Status status = context.check(); !status.ok()) return status;
  return mesh;
}

}  // namespace

absl::StatusOr<RepairedMesh> repair(PolygonSoup soup, const ExecutionContext& context) {
  RepairedMesh result;
  RepairReport& report = result.report;
  context.progress("repair", 0);
  std::vector<std::uint32_t> weld_map;
  if (!soup.shares_vertices) {
    std::vector<std::uint32_t> all(soup.positions.size());
    std::iota(all.begin(), all.end(), 0u);
    Weld welding = weld(soup.positions, all, context);
    report.welded_vertices = welding.welded;
    weld_map = std::move(welding.map);
  }
  if (absl::Status status = context.check(); !status.ok()) return status;
  FaceList faces = triangulate_all(soup, weld_map, context, report);
  if (absl::Status status = context.check(); !status.ok()) return status;
  if (faces.triangles.empty()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("the mesh has no face with an area (all %d are degenerate)", soup.polygon_count()));
  }
  if (soup.attributes.colours.empty()) soup.indices = {}, soup.polygon_begin = {};  // nobody asks for them any more
  context.progress("repair", 0.3);
  const auto pair = [&] { return pair_halfedges(faces.triangles, soup.positions.size(), context); };
  HalfedgePairs pairs = pair();
  if (soup.shares_vertices) {
    weld_map = weld_borders(soup.positions, pairs.border, context, faces, report);
    if (!weld_map.empty()) pairs = pair();
  }
  if (pairs.may_have_duplicates) {
    faces.note_polygons();
    report.duplicate_faces = drop_duplicates(faces, context);
  }
  if (report.duplicate_faces > 0) pairs = pair();
  report.nonmanifold_edges = pairs.nonmanifold_edges;
  if (absl::Status status = context.check(); !status.ok()) return status;
  context.progress("repair", 0.6);
  std::vector<char> flip;
  if (!pairs.is_oriented) {
    flip = find_flips(faces.triangles, pairs.twins, context, report);
    if (report.flipped_faces > 0) apply_flips(flip, context, faces, pairs.twins);
  }
  if (absl::Status status = context.check(); !status.ok()) return status;
  context.progress("repair", 0.8);
  result.sources = sources_of(faces, flip, context);
  std::vector<std::uint32_t> source;
  absl::StatusOr<TriangleMesh> split =
      split_into_fans(soup.positions, std::move(faces.triangles), std::move(pairs.twins), context, source, report);
  if (!split.ok()) return split.status();
  result.mesh = *std::move(split);
  soup.positions = {};
  report.unused_vertices -= report.welded_vertices;
  const double diagonal = bounding_box(result.mesh).diagonal();
  if (!(diagonal >= kSmallestDiagonal && diagonal <= kLargestDiagonal)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("the mesh's bounding box has a diagonal of %g; between %g and %g are possible: scale the mesh", diagonal,
                        kSmallestDiagonal, kLargestDiagonal));
  }
  result.attributes = carry_attributes(soup, weld_map, faces, source);
  context.progress("repair", 1);
  return result;
}

}  // namespace curvecast
