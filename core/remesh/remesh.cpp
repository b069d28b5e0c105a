#include "core/remesh/remesh.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "core/base/memory_claim.h"
#include "core/mesh/surface_walk.h"
#include "core/mesh/topology.h"
#include "core/remesh/angle_flips.h"
#include "core/remesh/fit.h"
#include "core/remesh/halfedge_mesh.h"
#include "core/remesh/insert_points.h"
#include "core/remesh/line_points.h"
#include "core/remesh/parameter_triangulation.h"
#include "core/remesh/relax.h"
#include "core/remesh/remove_vertices.h"
#include "core/remesh/surface_lines.h"

namespace curvecast {
namespace {

absl::Status check(const TriangleMesh& surface, std::span<const FacePlace> points, const RemeshOptions& options) {
  if (options.relaxations < 0 || options.relaxations > kMaxRelaxations) {
    return absl::InvalidArgumentError(
        absl::StrFormat("relaxations = %d; it must lie in 0 .. %d", options.relaxations, kMaxRelaxations));
  }
  if (!(options.feature_degrees >= 0 && options.feature_degrees <= 180)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("feature_degrees = %g; it must lie in 0 .. 180 degrees", options.feature_degrees));
  }
  if (options.method == RemeshMethod::kParameter && options.feature_degrees > 0) {
    return absl::InvalidArgumentError("features are kept by the method of the surface alone");
  }
  if (points.size() < 3) return absl::InvalidArgumentError(absl::StrFormat("a mesh cannot be made of %d points", points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [face, u, v] = points[i];
    if (face < surface.face_count() && u >= 0 && v >= 0 && u + v <= 1.001f) continue;
    return absl::InvalidArgumentError(
        absl::StrFormat("point %d lies at weights %g, %g of face %d; there are %d faces", i, u, v, face, surface.face_count()));
  }
  return absl::OkStatus();
}

/// What has to stay.
std::string in_words(const Topology& topology) {
  return absl::StrFormat("%d component%s, genus %d, %d border%s", topology.components, topology.components == 1 ? "" : "s",
                         topology.genus, topology.boundary_loops, topology.boundary_loops == 1 ? "" : "s");
}

absl::Status too_few(std::size_t points, std::size_t lacking, const Topology& topology) {
  return absl::InvalidArgumentError(absl::StrFormat("%d vertices are too few for a surface of %s: it takes about %d", points,
                                                    in_words(topology), points + lacking));
}

class Remesher {
 public:
  Remesher(const TriangleMesh& surface, std::span<const FacePlace> points, const RemeshOptions& options,
           const ExecutionContext& context, std::span<const ChartView> charts)
      : surface_(surface),
        points_(points),
        options_(options),
        context_(context),
        charts_(charts),
        walk_(surface),
        topology_(analyse_topology(surface, context)),
        mesh_({}, 0) {}

  absl::StatusOr<Remeshed> run() {
    const bool on_surface = options_.method == RemeshMethod::kSurface;
    if (absl::Status status = on_surface ? triangulate_on_surface() : triangulate_in_square(); !status.ok()) return status;
    compact();
    relax(mesh_, walk_, places_, options_.relaxations, context_);
    if (options_.fit) fit(mesh_, walk_, places_, context_);
    if (absl::Status status = context_.check(); !status.ok()) return status;
    return finish();
  }

 private:
  absl::Status triangulate_on_surface() {
    std::vector<bool> sharp;
    if (options_.feature_degrees > 0) sharp = sharp_edges(surface_, options_.feature_degrees, context_);
    const std::vector<SurfaceLine> lines = surface_lines(surface_, std::move(sharp), context_);
    const absl::StatusOr<LinePoints> on_lines = place(lines);
    if (!on_lines.ok()) return on_lines.status();
    mesh_ = HalfedgeMesh(surface_, points_.size());
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (lines[i].is_border || !on_lines->used[i]) continue;
      for (const std::uint32_t h : lines[i].halfedges) mesh_.mark_feature(h);
    }
    insert_points(mesh_, inner_);
    insert_line_points(mesh_, surface_, on_lines->places);
    return remove_own();
  }

  absl::Status triangulate_in_square() {
    std::vector<std::vector<BorderPiece>> borders;
    for (const ChartView& chart : charts_) borders.push_back(chart_border(surface_, chart));
    std::vector<SurfaceLine> lines = surface_lines(surface_, cut_edges(surface_, borders), context_);
    for (SurfaceLine& line : lines) line.has_loose_end = false;  // none is noise
    const absl::StatusOr<LinePoints> on_lines = place(lines);
    if (!on_lines.ok()) return on_lines.status();
    absl::StatusOr<TriangleMesh> made =
        triangulate_in_parameter(surface_, charts_, borders, {inner_, lines, *on_lines}, context_);
    if (!made.ok()) return made.status();
    mesh_ = HalfedgeMesh(*std::move(made), 0);
    for (std::size_t v = 0; v < places_.size(); ++v) mesh_.positions[v] = places_[v].position;
    AngleFlips flips(mesh_);
    flips.add_all();
    flips.run();
    return context_.check();
  }

  /// Decides where the vertices lie: on lines, and inside.
  absl::StatusOr<LinePoints> place(std::span<const SurfaceLine> lines) {
    std::vector<Vec3d> positions;
    positions.reserve(points_.size());
    for (const FacePlace& p : points_) positions.push_back(place_of(p).position);
    LinePoints on_lines = place_on_lines(surface_, lines, positions, context_);
    if (absl::Status status = context_.check(); !status.ok()) return status;
    const std::size_t wanted = on_lines.corners.size() + on_lines.places.size();
    if (on_lines.stand_ins.size() < wanted) return too_few(points_.size(), wanted - on_lines.stand_ins.size(), topology_);
    inner_.reserve(points_.size());
    places_.resize(surface_.vertex_count());
    corners_ = on_lines.corners;
    for (const std::uint32_t v : corners_) places_[v] = place_of_vertex(v);
    auto stand_in = on_lines.stand_ins.begin();
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      if (stand_in != on_lines.stand_ins.end() && *stand_in == i) {
        ++stand_in;
        continue;
      }
      inner_.push_back(points_[i]);
      places_.push_back(place_of(points_[i]));
    }
    for (const LinePlace& p : on_lines.places) places_.push_back(place_on_line(p));
    return on_lines;
  }

  /// Takes the surface's own vertices out. Small components may lack points to stand on: there some of their own stay, and as
  /// many points go elsewhere.
  absl::Status remove_own() {
    const auto own = static_cast<std::uint32_t>(surface_.vertex_count()), all = static_cast<std::uint32_t>(mesh_.vertex_count());
    VertexRemover remover(mesh_);
    std::vector<std::uint32_t> vertices(own);
    std::iota(vertices.begin(), vertices.end(), 0u);
    std::vector<bool> stays(own, false);
    for (const std::uint32_t v : corners_) stays[v] = true;
    std::erase_if(vertices, [&](std::uint32_t v) { return stays[v] || !mesh_.has_vertex(v); });
    const std::vector<std::uint32_t> left = remover.remove(vertices, context_);
    if (absl::Status status = context_.check(); !status.ok()) return status;
    if (left.empty()) return absl::OkStatus();
    for (const std::uint32_t v : left) places_[v] = place_of_vertex(v);
    // Spread over all of them, more than have to go: some of them cannot.
    std::vector<std::uint32_t> spare;
    const std::size_t step = std::max<std::size_t>(1, (all - own) / (4 * left.size()));
    for (std::size_t v = own; v < all; v += step) spare.push_back(static_cast<std::uint32_t>(v));
    const std::size_t kept = spare.size();
    if (4 * left.size() > points_.size() || kept - remover.remove(spare, context_, left.size()).size() < left.size()) {
      return too_few(points_.size(), left.size(), topology_);
    }
    return context_.check();
  }

  WalkPlace place_of_vertex(std::uint32_t v) const {
    const std::uint32_t h = walk_.fans().outgoing(v);
    return walk_.place(h / 3, h % 3 == 1 ? 1 : 0, h % 3 == 2 ? 1 : 0);
  }

  WalkPlace place_of(const FacePlace& p) const {
    return walk_.place(p.face, static_cast<double>(p.weight_1), static_cast<double>(p.weight_2));
  }
  WalkPlace place_on_line(const LinePlace& p) const {
    const std::uint32_t corner = p.halfedge % 3;
    double weights[3] = {};
    weights[corner] = 1 - p.part;
    weights[(corner + 1) % 3] = p.part;
    return walk_.place(p.halfedge / 3, weights[1], weights[2]);
  }

  /// Leaves out what has gone.
  void compact() {
    const std::vector<std::uint32_t> kept = mesh_.compact();
    for (std::size_t i = 0; i < kept.size(); ++i) places_[i] = places_[kept[i]];
    places_.resize(kept.size());
  }

  absl::StatusOr<Remeshed> finish() {
    Remeshed out;
    for (const WalkPlace& p : places_) {
      out.places.push_back({p.face, static_cast<float>(p.weight_1), static_cast<float>(p.weight_2)});
    }
    out.mesh = std::move(mesh_);
    const Topology found = analyse_topology(out.mesh, context_);
    if (absl::Status status = context_.check(); !status.ok()) return status;
    if (found.components != topology_.components || found.genus != topology_.genus ||
        found.boundary_loops != topology_.boundary_loops || out.mesh.vertex_count() != points_.size()) {
      return absl::InternalError(absl::StrFormat("the mesh of %d points has %d vertices, %s; the surface has %s", points_.size(),
                                                 out.mesh.vertex_count(), in_words(found), in_words(topology_)));
    }
    return out;
  }

  const TriangleMesh& surface_;
  const std::span<const FacePlace> points_;
  const RemeshOptions& options_;
  const ExecutionContext& context_;
  const std::span<const ChartView> charts_;
  const SurfaceWalk walk_;
  const Topology topology_;
  std::vector<FacePlace> inner_;        // points that become vertices themselves
  HalfedgeMesh mesh_;                   // the surface's, then the points'
  std::vector<WalkPlace> places_;       // of its vertices; of the surface's own only for those that stay
  std::vector<std::uint32_t> corners_;  // of lines: vertices of the surface that stay
};

/// For the surface, whose triangles the points are put into, and what becomes of them.
absl::Status claim_memory(const TriangleMesh& surface, std::size_t points, bool fit, MemoryClaim& claim) {
  constexpr double kPerFace = 160, kPerPoint = 420, kPerFittedPoint = 1000;
  const double bytes =
      kPerFace * static_cast<double>(surface.face_count()) + (fit ? kPerFittedPoint : kPerPoint) * static_cast<double>(points);
  return claim.set(static_cast<std::uint64_t>(bytes), absl::StrFormat("a mesh of %d points on %d triangles takes %s of memory",
                                                                      points, surface.face_count(), describe_bytes(bytes)));
}

}  // namespace

absl::StatusOr<Remeshed> remesh(const TriangleMesh& surface, std::span<const FacePlace> points, const RemeshOptions& options,
                                const ExecutionContext& context, std::span<const ChartView> charts) {
  if (absl::Status status = check(surface, points, options); !status.ok()) return status;
  MemoryClaim claim(context);
  if (absl::Status status = claim_memory(surface, points.size(), options.fit, claim); !status.ok()) return status;
  context.progress("triangulate", 0);
  return Remesher(surface, points, options, context, charts).run();
}

}  // namespace curvecast
