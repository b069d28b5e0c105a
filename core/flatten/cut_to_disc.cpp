#include "core/flatten/cut_to_disc.h"

#include <absl/strings/str_format.h>

#include <numeric>

#include "core/flatten/cut_graph.h"
#include "core/mesh/topology.h"

namespace curvecast {
namespace {

/// The disc under construction, with its connectivity.
class DiscBuilder {
 public:
  DiscBuilder(const TriangleMesh& piece, const std::vector<bool>& cut) {
    disc_.twins = piece.twins;
    for (std::uint32_t h = 0; h < disc_.twins.size(); ++h) {
      if (cut[h]) disc_.twins[h] = kNone;
    }
    std::vector<std::uint32_t> fan_of_corner;
    const std::uint32_t fans = label_fans(disc_.twins, fan_of_corner);
    disc_.triangles.resize(piece.face_count());
    disc_.positions.resize(fans);
    for (std::uint32_t h = 0; h < fan_of_corner.size(); ++h) {
      const std::uint32_t fan = fan_of_corner[h];
      disc_.triangles[h / 3][h % 3] = fan;
      disc_.positions[fan] = piece.positions[piece.triangles[h / 3][h % 3]];
    }
    disc_.face_of.resize(piece.face_count());
    std::iota(disc_.face_of.begin(), disc_.face_of.end(), 0u);
  }

  absl::StatusOr<DiscMesh> build() {
    std::vector<std::uint32_t> loop = trace_border();
    if (loop.size() < 4) {
      // The square needs four corners.
      for (const std::uint32_t h : loop) split(h);
      loop = trace_border();
    }
    split_dividing_edges(loop);
    loop = trace_border();
    std::size_t open = 0;
    for (const std::uint32_t t : disc_.twins) open += t == kNone;
    if (loop.size() != open) return absl::InternalError(absl::StrFormat("the cut left %d border edges in several loops", open));
    for (const std::uint32_t h : loop) disc_.border.push_back(disc_.from(h));
    return std::move(disc_);
  }

 private:
  /// The halfedges of the border loop that the first open halfedge belongs to.
  std::vector<std::uint32_t> trace_border() const {
    std::uint32_t start = 0;
    while (start < disc_.twins.size() && disc_.twins[start] != kNone) ++start;
    if (start == disc_.twins.size()) return {};
    std::vector<std::uint32_t> loop;
    std::uint32_t h = start;
    do {
      loop.push_back(h);
      h = next_on_border(disc_.twins, h);
    } while (h != start);
    return loop;
  }

  void split_dividing_edges(const std::vector<std::uint32_t>& loop) {
    std::vector<bool> on_border(disc_.vertex_count(), false);
    for (const std::uint32_t h : loop) on_border[disc_.from(h)] = true;
    for (std::uint32_t h = 0; h < disc_.twins.size(); ++h) {  // splits move edges to the end
      const std::uint32_t a = disc_.from(h);
      const std::uint32_t b = disc_.to(h);
      // What ends at a new vertex is no longer a dividing edge.
      if (disc_.twins[h] != kNone && a < on_border.size() && b < on_border.size() && on_border[a] && on_border[b]) split(h);
    }
  }

  void join(std::uint32_t a, std::uint32_t b) {
    disc_.twins[a] = b;
    if (b != kNone) disc_.twins[b] = a;
  }

  /// Halves halfedge h = (a, b) of face (a, b, c) at m: h becomes (a, m) in (a, m, c), and a new face (m, b, c) starts with the
  /// returned halfedge (m, b).
  std::uint32_t halve_face(std::uint32_t h, std::uint32_t m) {
    const std::uint32_t f = h / 3;
    const std::uint32_t h1 = next_halfedge(h);
    const std::uint32_t b = disc_.triangles[f][h1 % 3];
    const std::uint32_t c = disc_.triangles[f][previous_halfedge(h) % 3];
    const auto fresh = static_cast<std::uint32_t>(disc_.twins.size());
    disc_.triangles.push_back({m, b, c});
    disc_.face_of.push_back(disc_.face_of[f]);
    disc_.triangles[f][h1 % 3] = m;
    disc_.twins.insert(disc_.twins.end(), 3, kNone);
    join(fresh + 1, disc_.twins[h1]);
    join(h1, fresh + 2);
    return fresh;
  }

  void split(std::uint32_t h) {
    const std::uint32_t a = disc_.from(h);
    const std::uint32_t b = disc_.to(h);
    const std::uint32_t t = disc_.twins[h];
    const auto m = static_cast<std::uint32_t>(disc_.vertex_count());
    disc_.positions.emplace_back(0.5 * (disc_.positions[a] + disc_.positions[b]));
    const std::uint32_t rest = halve_face(h, m);
    if (t == kNone) return;
    const std::uint32_t rest_of_twin = halve_face(t, m);
    join(h, rest_of_twin);
    join(t, rest);
  }

  DiscMesh disc_;
};

}  // namespace

absl::StatusOr<DiscMesh> cut_to_disc(const TriangleMesh& piece, std::span<const std::uint32_t> extremities) {
  if (piece.triangles.empty()) return absl::InvalidArgumentError("there are no faces to cut");
  const absl::StatusOr<std::vector<bool>> cut = cut_graph(piece, extremities);
  if (!cut.ok()) return cut.status();
  return DiscBuilder(piece, *cut).build();
}

}  // namespace curvecast
