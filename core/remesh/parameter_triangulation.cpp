#include "core/remesh/parameter_triangulation.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "core/remesh/halfedge_mesh.h"
#include "core/remesh/insert_points.h"
#include "core/remesh/remove_vertices.h"

namespace curvecast {
namespace {

/// Weights of the second and third corner of a triangle for a point of its plane.
std::pair<double, double> weights_of(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d u = b - a, v = c - a, w = p - a;
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), uw = u.dot(w), vw = v.dot(w), determinant = uu * vv - uv * uv;
  if (!(determinant > 0)) return {1.0 / 3, 1.0 / 3};
  return {(vv * uw - uv * vw) / determinant, (uu * vw - uv * uw) / determinant};
}

/// The index of things by what they belong to.
class Groups {
 public:
  template <typename Key>
  Groups(std::size_t things, std::size_t keys, const Key& key) : begin_(keys + 1, 0), things_(things) {
    for (std::uint32_t i = 0; i < things; ++i) ++begin_[key(i) + 1];
    for (std::size_t k = 0; k < keys; ++k) begin_[k + 1] += begin_[k];
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t i = 0; i < things; ++i) things_[next[key(i)]++] = i;
  }
  std::span<const std::uint32_t> of(std::size_t key) const {
    return std::span(things_).subspan(begin_[key], begin_[key + 1] - begin_[key]);
  }

 private:
  std::vector<std::uint32_t> begin_, things_;
};

class ParameterTriangulation {
 public:
  ParameterTriangulation(const TriangleMesh& surface, const ParameterPoints& points, const ExecutionContext& context)
      : surface_(surface),
        points_(points),
        context_(context),
        inner_of_(points.inner.size(), surface.face_count(), [&](std::uint32_t i) { return points.inner[i].face; }),
        places_of_(points.on_lines.places.size(), surface.twins.size(),
                   [&](std::uint32_t i) { return canonical(points.on_lines.places[i].halfedge); }),
        is_corner_(surface.vertex_count(), false),
        line_of_(surface.twins.size(), kNone) {
    for (const std::uint32_t v : points.on_lines.corners) is_corner_[v] = true;
    for (std::uint32_t l = 0; l < points.lines.size(); ++l) {
      for (const std::uint32_t h : points.lines[l].halfedges) line_of_[h] = line_of_[canonical(h)] = l;
    }
    out_.positions.resize(surface.vertex_count() + points.inner.size() + points.on_lines.places.size(), Vec3d::Zero());
  }

  absl::Status add(const ChartView& chart, std::span<const BorderPiece> border) {
    TriangleMesh plane;
    for (const Vec2d& uv : chart.uv) plane.positions.emplace_back(uv.x(), uv.y(), 0);
    plane.triangles.assign(chart.triangles.begin(), chart.triangles.end());
    plane.twins.assign(chart.twins.begin(), chart.twins.end());
    HalfedgeMesh flat(plane, 0);
    vertex_.assign(flat.vertex_count(), kNone);
    line_after_.assign(flat.vertex_count(), kNone);
    insert_inner(chart, flat);
    insert_on_border(plane, border, flat);
    std::vector<std::uint32_t> own;
    for (std::uint32_t v = 0; v < plane.vertex_count(); ++v) {
      if (vertex_[v] == kNone) own.push_back(v);
    }
    const std::vector<std::uint32_t> left = VertexRemover(flat).remove(own, context_);
    if (absl::Status status = context_.check(); !status.ok()) return status;
    if (!left.empty()) {
      return absl::InvalidArgumentError(
          absl::StrFormat("a chart has too few points to be triangulated by itself: it takes about "
                          "%d more",
                          left.size()));
    }
    open_loops(flat);
    append(flat);
    return absl::OkStatus();
  }

  absl::StatusOr<TriangleMesh> stitch() && {
    std::sort(seams_.begin(), seams_.end());
    std::size_t alone = 0;
    for (std::size_t i = 0; i < seams_.size(); ++i) {
      if (points_.lines[seams_[i].line].is_border) continue;
      if (i + 1 == seams_.size() || seams_[i].edge() != seams_[i + 1].edge() || seams_[i].forward == seams_[i + 1].forward) {
        ++alone;
        continue;
      }
      const std::uint32_t g = seams_[i].halfedge, h = seams_[++i].halfedge;
      out_.twins[g] = h, out_.twins[h] = g;
    }
    if (alone > 0) return absl::InternalError(absl::StrFormat("%d edges along cuts have no other side", alone));
    return std::move(out_);
  }

 private:
  /// An edge of a chart's border.
  struct Seam {
    std::uint32_t line, low, high;  // vertices
    bool forward;                   // from the lower one
    std::uint32_t halfedge;         // of the whole mesh

    std::tuple<std::uint32_t, std::uint32_t, std::uint32_t> edge() const { return {line, low, high}; }
    bool operator<(const Seam& other) const {
      return std::tuple(edge(), forward, halfedge) < std::tuple(other.edge(), other.forward, other.halfedge);
    }
  };

  std::uint32_t canonical(std::uint32_t h) const { return std::min(h, surface_.twins[h]); }  // kNone is the largest

  void insert_inner(const ChartView& chart, HalfedgeMesh& flat) {
    // A face may have been divided: each of its points lies in one of the parts.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> parts;
    for (std::uint32_t t = 0; t < chart.face_of.size(); ++t) {
      if (!inner_of_.of(chart.face_of[t]).empty()) parts.emplace_back(chart.face_of[t], t);
    }
    std::sort(parts.begin(), parts.end());
    std::vector<FacePlace> places;
    for (std::size_t i = 0, end = 0; i < parts.size(); i = end) {
      while (end < parts.size() && parts[end].first == parts[i].first) ++end;
      for (const std::uint32_t point : inner_of_.of(parts[i].first)) {
        places.push_back(place_in(chart, std::span(parts).subspan(i, end - i), points_.inner[point]));
        vertex_.push_back(static_cast<std::uint32_t>(surface_.vertex_count() + point));
      }
    }
    line_after_.resize(vertex_.size(), kNone);
    insert_points(flat, places);
  }

  FacePlace place_in(const ChartView& chart, std::span<const std::pair<std::uint32_t, std::uint32_t>> parts,
                     const FacePlace& place) const {
    const Triangle& face = surface_.triangles[place.face];
    const Vec3d& a = surface_.positions[face[0]];
    const Vec3d p = a + double{place.weight_1} * (surface_.positions[face[1]] - a) +
                    double{place.weight_2} * (surface_.positions[face[2]] - a);
    FacePlace best{};
    double most = -std::numeric_limits<double>::infinity();
    for (const auto& part : parts) {
      const Triangle& t = chart.triangles[part.second];
      const auto [u, v] = weights_of(p, chart.positions[t[0]], chart.positions[t[1]], chart.positions[t[2]]);
      const double least = std::min({u, v, 1 - u - v});
      if (!(least > most)) continue;
      most = least;
      const double second = std::clamp(u, 0.0, 1.0);
      best = {part.second, static_cast<float>(second), static_cast<float>(std::clamp(v, 0.0, 1 - second))};
    }
    return best;
  }

  void insert_on_border(const TriangleMesh& plane, std::span<const BorderPiece> border, HalfedgeMesh& flat) {
    std::vector<LinePlace> places;
    std::vector<std::pair<double, std::uint32_t>> some;
    const auto first_on_lines = static_cast<std::uint32_t>(surface_.vertex_count() + points_.inner.size());
    for (const BorderPiece& piece : border) {
      const std::uint32_t from = plane.from(piece.halfedge), line = line_of_[canonical(piece.edge)];
      line_after_[from] = line;
      if (const std::uint32_t v = surface_.from(piece.edge); piece.first == 0 && is_corner_[v]) vertex_[from] = v;
      some.clear();
      for (const std::uint32_t i : places_of_.of(canonical(piece.edge))) {
        const LinePlace& place = points_.on_lines.places[i];
        const double part = place.halfedge == piece.edge ? place.part : 1 - place.part;
        if (part > piece.first && part <= piece.last) some.emplace_back((part - piece.first) / (piece.last - piece.first), i);
      }
      std::sort(some.begin(), some.end());
      for (const auto& [part, i] : some) {
        places.push_back({piece.halfedge, std::min(part, 1 - 1e-9)});
        vertex_.push_back(first_on_lines + i);
        line_after_.push_back(line);
      }
    }
    insert_line_points(flat, plane, places);
  }

  /// Where a cut ends, both of its sides may meet in an edge from a vertex to itself: it is turned.
  void open_loops(HalfedgeMesh& flat) const {
    for (std::uint32_t h = 0; h < flat.twins.size(); ++h) {
      if (!flat.has_face(h / 3) || flat.twins[h] == kNone || vertex_[flat.from(h)] != vertex_[flat.to(h)]) continue;
      if (flat.may_flip(h)) flat.flip(h);
    }
  }

  void append(HalfedgeMesh& flat) {
    const std::vector<std::uint32_t> kept = flat.compact();
    const auto first = static_cast<std::uint32_t>(out_.twins.size());
    for (const Triangle& t : flat.triangles) {
      out_.triangles.push_back({vertex_[kept[t[0]]], vertex_[kept[t[1]]], vertex_[kept[t[2]]]});
    }
    for (std::uint32_t h = 0; h < flat.twins.size(); ++h) {
      out_.twins.push_back(flat.twins[h] == kNone ? kNone : first + flat.twins[h]);
      if (flat.twins[h] != kNone) continue;
      const std::uint32_t a = vertex_[kept[flat.from(h)]], b = vertex_[kept[flat.to(h)]];
      seams_.push_back({line_after_[kept[flat.from(h)]], std::min(a, b), std::max(a, b), a < b, first + h});
    }
  }

  const TriangleMesh& surface_;
  const ParameterPoints& points_;
  const ExecutionContext& context_;
  const Groups inner_of_;               // points, by face
  const Groups places_of_;              // places on lines, by edge
  std::vector<bool> is_corner_;         // per vertex of the surface
  std::vector<std::uint32_t> line_of_;  // per edge of the surface
  TriangleMesh out_;
  std::vector<Seam> seams_;
  // Of the chart that is looked at, per vertex:
  std::vector<std::uint32_t> vertex_;      // of the whole mesh; kNone: one that goes
  std::vector<std::uint32_t> line_after_;  // along which the border goes on from there
};

/// Counts edges that join two vertices which another edge joins too, or a vertex with itself, after turning those that can be.
std::size_t count_doubles(HalfedgeMesh& mesh) {
  for (int round = 0;; ++round) {
    std::vector<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>> edges;
    for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
      if (mesh.twins[h] == kNone || mesh.twins[h] > h) {
        edges.emplace_back(std::min(mesh.from(h), mesh.to(h)), std::max(mesh.from(h), mesh.to(h)), h);
      }
    }
    std::sort(edges.begin(), edges.end());
    std::size_t doubles = 0, turned = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const auto [a, b, h] = edges[i];
      const bool is_double = i > 0 && std::get<0>(edges[i - 1]) == a && std::get<1>(edges[i - 1]) == b;
      if (a != b && !is_double) continue;
      ++doubles;
      if (!mesh.may_flip(h)) continue;
      mesh.flip(h);
      ++turned;
    }
    constexpr int kMostRounds = 10;
    if (turned == 0 || round == kMostRounds) return doubles;
  }
}

}  // namespace

absl::StatusOr<TriangleMesh> triangulate_in_parameter(const TriangleMesh& surface, std::span<const ChartView> charts,
                                                      std::span<const std::vector<BorderPiece>> borders,
                                                      const ParameterPoints& points, const ExecutionContext& context) {
  ParameterTriangulation work(surface, points, context);
  for (std::size_t c = 0; c < charts.size(); ++c) {
    if (absl::Status status = work.add(charts[c], borders[c]); !status.ok()) return status;
  }
  absl::StatusOr<TriangleMesh> stitched = std::move(work).stitch();
  if (!stitched.ok()) return stitched.status();
  HalfedgeMesh mesh(*std::move(stitched), 0);
  if (const std::size_t doubles = count_doubles(mesh); doubles > 0) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%d edges would join two vertices that another edge joins: the cuts lie too near to each other for so few points",
        doubles));
  }
  return TriangleMesh(std::move(mesh));
}

}  // namespace curvecast
