#include "core/flatten/cut_to_disc.h"

#include <absl/strings/str_format.h>

#include "core/flatten/cut_graph.h"
#include "core/flatten/face_set.h"
#include "core/mesh/topology.h"

namespace curvecast {
namespace {

/// The piece as a mesh of its own.
TriangleMesh extract(const TriangleMesh& mesh, std::span<const std::uint32_t> faces) {
  const FaceSet set(faces, mesh);
  TriangleMesh piece;
  piece.twins.resize(3 * faces.size());
  for (std::uint32_t h = 0; h < piece.twins.size(); ++h) piece.twins[h] = set.halfedge(mesh.twins[3 * faces[h / 3] + h % 3]);
  std::vector<std::uint32_t> fan_of_corner;
  piece.positions.resize(label_fans(piece.twins, fan_of_corner));
  piece.triangles.resize(faces.size());
  for (std::uint32_t h = 0; h < fan_of_corner.size(); ++h) {
    piece.triangles[h / 3][h % 3] = fan_of_corner[h];
    piece.positions[fan_of_corner[h]] = mesh.positions[mesh.triangles[faces[h / 3]][h % 3]];
  }
  return piece;
}

/// The disc under construction, with its connectivity.
class DiscBuilder {
 public:
  DiscBuilder(const TriangleMesh& piece, const std::vector<bool>& cut, std::span<const std::uint32_t> faces)
      : twins_(piece.twins) {
    for (std::uint32_t h = 0; h < twins_.size(); ++h) {
      if (cut[h]) twins_[h] = kNone;
    }
    std::vector<std::uint32_t> fan_of_corner;
    const std::uint32_t fans = label_fans(twins_, fan_of_corner);
    disc_.triangles.resize(faces.size());
    disc_.positions.resize(fans);
    for (std::uint32_t h = 0; h < fan_of_corner.size(); ++h) {
      const std::uint32_t fan = fan_of_corner[h];
      disc_.triangles[h / 3][h % 3] = fan;
      disc_.positions[fan] = piece.positions[piece.triangles[h / 3][h % 3]];
    }
    disc_.face_of.assign(faces.begin(), faces.end());
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
    for (const std::uint32_t t : twins_) open += t == kNone;
    if (loop.size() != open) return absl::InternalError(absl::StrFormat("the cut left %d border edges in several loops", open));
    for (const std::uint32_t h : loop) disc_.border.push_back(disc_.triangles[h / 3][h % 3]);
    return std::move(disc_);
  }

 private:
  /// The halfedges of the border loop that the first open halfedge belongs to.
  std::vector<std::uint32_t> trace_border() const {
    std::uint32_t start = 0;
    while (start < twins_.size() && twins_[start] != kNone) ++start;
    if (start == twins_.size()) return {};
    std::vector<std::uint32_t> loop;
    std::uint32_t h = start;
    do {
      loop.push_back(h);
      h = next_on_border(twins_, h);
    } while (h != start);
    return loop;
  }

  void split_dividing_edges(const std::vector<std::uint32_t>& loop) {
    std::vector<bool> on_border(disc_.vertex_count(), false);
    for (const std::uint32_t h : loop) on_border[disc_.triangles[h / 3][h % 3]] = true;
    for (std::uint32_t h = 0; h < twins_.size(); ++h) {  // splits move edges to the end
      const std::uint32_t a = disc_.triangles[h / 3][h % 3];
      const std::uint32_t b = disc_.triangles[h / 3][(h + 1) % 3];
      // What ends at a new vertex is no longer a dividing edge.
      if (twins_[h] != kNone && a < on_border.size() && b < on_border.size() && on_border[a] && on_border[b]) split(h);
    }
  }

  void join(std::uint32_t a, std::uint32_t b) {
    twins_[a] = b;
    if (b != kNone) twins_[b] = a;
  }

  /// Halves halfedge h = (a, b) of face (a, b, c) at m: h becomes (a, m) in (a, m, c), and a new face (m, b, c) starts with the
  /// returned halfedge (m, b).
  std::uint32_t halve_face(std::uint32_t h, std::uint32_t m) {
    const std::uint32_t f = h / 3;
    const std::uint32_t h1 = next_halfedge(h);
    const std::uint32_t b = disc_.triangles[f][h1 % 3];
    const std::uint32_t c = disc_.triangles[f][previous_halfedge(h) % 3];
    const auto fresh = static_cast<std::uint32_t>(twins_.size());
    disc_.triangles.push_back({m, b, c});
    disc_.face_of.push_back(disc_.face_of[f]);
    disc_.triangles[f][h1 % 3] = m;
    twins_.insert(twins_.end(), 3, kNone);
    join(fresh + 1, twins_[h1]);
    join(h1, fresh + 2);
    return fresh;
  }

  void split(std::uint32_t h) {
    const std::uint32_t a = disc_.triangles[h / 3][h % 3];
    const std::uint32_t b = disc_.triangles[h / 3][(h + 1) % 3];
    const std::uint32_t t = twins_[h];
    const auto m = static_cast<std::uint32_t>(disc_.vertex_count());
    disc_.positions.push_back(0.5 * (disc_.positions[a] + disc_.positions[b]));
    const std::uint32_t rest = halve_face(h, m);
    if (t == kNone) return;
    const std::uint32_t rest_of_twin = halve_face(t, m);
    join(h, rest_of_twin);
    join(t, rest);
  }

  DiscMesh disc_;
  std::vector<std::uint32_t> twins_;
};

}  // namespace

absl::StatusOr<DiscMesh> cut_to_disc(const TriangleMesh& mesh, std::span<const std::uint32_t> faces, const CutOptions& options) {
  if (faces.empty()) return absl::InvalidArgumentError("there are no faces to cut");
  const TriangleMesh piece = extract(mesh, faces);
  std::vector<std::uint32_t> labels;
  if (label_components(piece.twins, labels) != 1) return absl::InvalidArgumentError("the faces to cut are not connected");
  return DiscBuilder(piece, cut_graph(piece, options), faces).build();
}

}  // namespace curvecast
