#include "core/mesh/repair.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <numeric>

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

bool is_degenerate(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return !((b - a).cross(c - a).norm() > kDegenerateHeight * longest);
}

/// Which polygon and which corners a face comes from is noted where the soup has something that hangs on them.
FaceList triangulate(const PolygonSoup& soup, const std::vector<std::uint32_t>& weld_map, RepairReport& report) {
  const bool wants_corners = !soup.attributes.uv.empty();
  const bool wants_polygons =
      !soup.attributes.face_colours.empty() || !soup.attributes.material_of_face.empty() || !soup.attributes.colours.empty();
  FaceList faces;
  faces.triangles.reserve(soup.indices.size() > 2 * soup.polygon_count() ? soup.indices.size() - 2 * soup.polygon_count() : 0);
  std::vector<std::uint32_t> vertices;
  std::vector<std::uint32_t> corners;  // of the soup, like `vertices`
  std::vector<Vec3d> places;
  std::vector<Triangle> pieces;
  for (std::size_t p = 0; p < soup.polygon_count(); ++p) {
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
      ++report.degenerate_faces;
      continue;
    }
    pieces.clear();
    if (vertices.size() == 3) {
      pieces.push_back({0, 1, 2});
    } else {
      ++report.triangulated_polygons;
      places.clear();
      for (const std::uint32_t v : vertices) places.push_back(soup.positions[v]);
      triangulate_polygon(places, pieces);
    }
    for (const Triangle& t : pieces) {
      const Triangle face = {vertices[t[0]], vertices[t[1]], vertices[t[2]]};
      const bool distinct = face[0] != face[1] && face[1] != face[2] && face[2] != face[0];
      if (!distinct || is_degenerate(soup.positions[face[0]], soup.positions[face[1]], soup.positions[face[2]])) {
        ++report.degenerate_faces;
        continue;
      }
      faces.triangles.push_back(face);
      if (wants_polygons) faces.polygons.push_back(static_cast<std::uint32_t>(p));
      if (wants_corners) faces.corners.insert(faces.corners.end(), {corners[t[0]], corners[t[1]], corners[t[2]]});
    }
  }
  return faces;
}

/// Joins surfaces that touch along borders but have vertices of their own there, as files do that cut along texture seams or
/// share no vertices at all. What is closed already is left alone, whatever it touches.
std::vector<std::uint32_t> weld_borders(const std::vector<Vec3d>& positions, FaceList& faces, EdgeGroups& groups,
                                        RepairReport& report) {
  const std::vector<std::uint32_t> border = border_vertices(groups, faces.triangles, positions.size());
  if (border.empty()) return {};
  Weld welding = weld(positions, border);
  if (welding.welded == 0) return {};
  report.welded_vertices = welding.welded;
  for (Triangle& face : faces.triangles) {
    for (std::uint32_t& v : face) v = welding.map[v];
  }
  groups = group_edges(faces.triangles, positions.size());
  return std::move(welding.map);
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

void apply_flips(const std::vector<char>& flip, FaceList& faces, std::vector<std::uint32_t>& twins) {
  // Turning (a, b, c) into (a, c, b) makes halfedge 0 the new 2 and the other way round.
  const auto renamed = [&](std::uint32_t h) { return flip[h / 3] ? 3 * (h / 3) + 2 - h % 3 : h; };
  std::vector<std::uint32_t> moved(twins.size());
  for (std::uint32_t h = 0; h < twins.size(); ++h) moved[renamed(h)] = twins[h] == kNone ? kNone : renamed(twins[h]);
  twins = std::move(moved);
  for (std::size_t f = 0; f < flip.size(); ++f) {
    if (flip[f]) faces.flip(f);
  }
}

/// Gives every fan of faces around a vertex a vertex of its own, numbered by first use; `source` tells whose it was.
TriangleMesh split_into_fans(const std::vector<Vec3d>& positions, const std::vector<Triangle>& triangles,
                             std::vector<std::uint32_t> twins, std::vector<std::uint32_t>& source, RepairReport& report) {
  TriangleMesh mesh;
  std::vector<std::uint32_t> fan_of_corner;
  const std::uint32_t fans = label_fans(twins, fan_of_corner);
  mesh.twins = std::move(twins);
  mesh.positions.resize(fans);
  source.resize(fans);
  mesh.triangles.resize(triangles.size());
  std::vector<bool> used(positions.size(), false);
  for (std::uint32_t h = 0; h < fan_of_corner.size(); ++h) {
    const std::uint32_t v = triangles[h / 3][h % 3];
    mesh.triangles[h / 3][h % 3] = fan_of_corner[h];
    mesh.positions[fan_of_corner[h]] = positions[v];
    source[fan_of_corner[h]] = v;
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
  std::vector<std::uint32_t> weld_map;
  if (!soup.shares_vertices) {
    std::vector<std::uint32_t> all(soup.positions.size());
    std::iota(all.begin(), all.end(), 0u);
    Weld welding = weld(soup.positions, all);
    report.welded_vertices = welding.welded;
    weld_map = std::move(welding.map);
  }
  FaceList faces = triangulate(soup, weld_map, report);
  if (faces.triangles.empty()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("the mesh has no face with an area (all %d are degenerate)", soup.polygon_count()));
  }
  if (absl::Status status = context.check(); !status.ok()) return status;
  context.progress("repair", 0.3);
  EdgeGroups groups = group_edges(faces.triangles, soup.positions.size());
  if (soup.shares_vertices) weld_map = weld_borders(soup.positions, faces, groups, report);
  HalfedgePairs pairs = pair_halfedges(faces, std::move(groups), soup.positions.size());
  report.duplicate_faces = pairs.duplicate_faces;
  report.nonmanifold_edges = pairs.nonmanifold_edges;
  const std::vector<char> flip = find_flips(faces.triangles, pairs.twins, report);
  if (report.flipped_faces > 0) apply_flips(flip, faces, pairs.twins);
  context.progress("repair", 0.8);
  std::vector<std::uint32_t> source;
  result.mesh = split_into_fans(soup.positions, faces.triangles, std::move(pairs.twins), source, report);
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
