// A manifold triangle mesh that can be changed: points put in, edges turned, vertices taken out.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// Halfedges are those of TriangleMesh. Faces and vertices that have gone keep their numbers until compacted. Every change leaves
/// the surface manifold, with the same components, genus and borders; what would not is refused by the question before it.
class HalfedgeMesh : public TriangleMesh {
 public:
  /// Precondition: `mesh` is as repair() leaves it. Room for `more` vertices is made at once.
  HalfedgeMesh(TriangleMesh mesh, std::size_t more);

  bool has_vertex(std::uint32_t v) const { return outgoing_[v] != kNone; }
  bool has_face(std::uint32_t f) const { return triangles[f][0] != kNone; }
  std::uint32_t apex(std::uint32_t h) const { return triangles[h / 3][(h + 2) % 3]; }
  /// A halfedge that leaves v; on the border the border's.
  std::uint32_t outgoing(std::uint32_t v) const { return outgoing_[v]; }
  bool on_border(std::uint32_t v) const { return twins[outgoing_[v]] == kNone; }

  /// Makes the edge of h a feature: it is never turned, and its vertices go along features only.
  void mark_feature(std::uint32_t h);
  bool is_feature(std::uint32_t h) const { return !features_.empty() && features_[h]; }
  /// Says whether v lies on a border or a feature.
  bool on_line(std::uint32_t v) const { return on_border(v) || count_features(v) > 0; }

  /// Calls visit(h) for the halfedges that leave v, counter-clockwise; on the border first with the border's own. The halfedge of
  /// the last face that comes back to v along the border is not among them.
  template <typename Visit>
  void for_each_outgoing(std::uint32_t v, Visit&& visit) const {
    std::uint32_t h = outgoing_[v];
    do {
      visit(h);
      h = twins[previous_halfedge(h)];
    } while (h != kNone && h != outgoing_[v]);
  }
  /// Calls visit(w) for the neighbours of v, counter-clockwise; on the border from the next to the previous on it.
  template <typename Visit>
  void for_each_neighbour(std::uint32_t v, Visit&& visit) const {
    std::uint32_t h = outgoing_[v];
    for (;;) {
      visit(to(h));
      const std::uint32_t back = previous_halfedge(h);
      h = twins[back];
      if (h == kNone) return visit(from(back));
      if (h == outgoing_[v]) return;
    }
  }
  /// Says whether an edge joins two vertices.
  bool has_edge(std::uint32_t v, std::uint32_t w) const;

  /// Adds a vertex that no face has yet.
  std::uint32_t add_vertex(const Vec3d& position);
  /// Makes three faces of f around v, which is new. The first keeps the number and its first side, the others follow at the end.
  void split_face(std::uint32_t f, std::uint32_t v);
  /// Puts v, which is new, on an edge: h goes on to v, and halfedge (returned) from there.
  std::uint32_t split_edge(std::uint32_t h, std::uint32_t v);

  /// Says whether the edge of h can be turned: it is inside and no feature, and no edge joins the corners across it. Both
  /// triangles differ.
  bool may_flip(std::uint32_t h) const;
  /// Turns the edge of h within its two triangles: it runs between their other corners then, from that across to that of h.
  void flip(std::uint32_t h);

  /// Says whether from(h) can be moved onto to(h) without changing the topology, of features too: the link condition.
  bool may_collapse(std::uint32_t h) const;
  /// Moves from(h) onto to(h): one vertex, two faces fewer (one at the border).
  void collapse(std::uint32_t h);

  /// Numbers what is left anew, vertices and faces in their order; returns which vertices these were.
  std::vector<std::uint32_t> compact();

 private:
  void join(std::uint32_t a, std::uint32_t b) {
    if (a != kNone) twins[a] = b;
    if (b != kNone) twins[b] = a;
  }
  std::uint32_t add_face(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  std::uint32_t count_features(std::uint32_t v) const;
  bool keeps_features(std::uint32_t h) const;
  void set_feature(std::uint32_t h, bool is_one) {
    if (!features_.empty() && h != kNone) features_[h] = is_one;
  }

  std::vector<std::uint32_t> outgoing_;  // per vertex; kNone: it is gone, or no face has it yet
  std::vector<bool> features_;           // per halfedge; empty: there are none
};

}  // namespace curvecast
