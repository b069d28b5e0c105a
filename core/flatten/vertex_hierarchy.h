// A mesh that gives up its vertices level by level, and takes them back in the reverse order.
// Source: half-edge collapses as in Kobbelt, Campagna, Seidel, "A general framework for mesh decimation" (1998); independent sets
// as in Dobkin, Kirkpatrick, "A linear algorithm for determining the separation of convex polyhedra" (1985).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/flatten/vertex_blocks.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// The vertices of one level are independent: no two are neighbours, neither when they go nor in any finer mesh. A vertex goes by
/// moving onto a neighbour, which leaves its topology and that of the border as they are; a border vertex moves along the border.
/// The mesh has no inner edge between two border vertices, and never gets one. Not thread-safe, but rings may be read from many
/// threads. Deterministic.
class VertexHierarchy {
 public:
  /// Keeps a reference to the mesh's positions and a copy of the rest. `pinned` vertices never go.
  VertexHierarchy(const TriangleMesh& mesh, std::span<const std::uint32_t> pinned);
  VertexHierarchy(TriangleMesh&&, std::span<const std::uint32_t>) = delete;

  struct Level {
    float highest;                         // cost of what may go
    std::vector<std::uint32_t> halfedges;  // along which vertices moved, from where they were
  };

  /// Makes levels until at most `target` vertices are left or no more can go. Cheap vertices (flat, in coarse enough triangles)
  /// go first. Where the context is cancelled there are fewer levels.
  void coarsen(std::size_t target, const ExecutionContext& context = {});
  /// Makes the levels of another hierarchy, for much less than coarsen() does, whose mesh differs from this one by cuts and what
  /// lies beside them: where vertices cannot go as they did there, the cheapest go as ever. Precondition: there are no levels.
  void coarsen_like(std::span<const Level> levels, const ExecutionContext& context = {});

  std::size_t level_count() const { return levels_.size(); }
  /// The levels, of which nothing is left here.
  std::vector<Level> take_levels() && { return std::move(levels_); }
  /// Returns the vertices that went with level l, in the order in which they went.
  std::vector<std::uint32_t> level(std::size_t l) const;
  /// Returns the vertices that were left, ascending.
  const std::vector<std::uint32_t>& base() const { return base_; }
  /// Takes the vertices of the last level back.
  void restore_level();

  /// Calls visit(next) for the neighbours of v counter-clockwise; for a border vertex from the next to the previous one on the
  /// border. v is there.
  template <typename Visit>
  void for_each_neighbour(std::uint32_t v, Visit&& visit) const {
    std::uint32_t h = outgoing_[v];
    for (;;) {
      visit(to(h));
      const std::uint32_t back = previous_halfedge(h);
      h = twins_[back];
      if (h == kNone) return visit(from(back));
      if (h == outgoing_[v]) return;
    }
  }
  bool on_border(std::uint32_t v) const { return border_[v] != 0; }

  /// Returns the mesh of the vertices in base(), numbered by their places there. No level has been restored.
  TriangleMesh base_mesh() const;

 private:
  struct Candidate {
    float cost;              // infinite: the vertex cannot go
    std::uint32_t halfedge;  // from the vertex to where it would move
  };
  static constexpr std::uint32_t kMaxDegree = 14;

  std::uint32_t from(std::uint32_t h) const { return triangles_[h / 3][h % 3]; }
  std::uint32_t to(std::uint32_t h) const { return triangles_[h / 3][(h + 1) % 3]; }
  bool may_collapse(std::uint32_t h) const;
  Candidate best_candidate(std::uint32_t v) const;
  void collapse(std::uint32_t h);
  void restore(std::uint32_t h);
  void relabel(std::uint32_t h, std::uint32_t v);
  float typical_cost() const;
  bool is_gone(std::uint32_t h) const;
  void remove(std::uint32_t h, std::vector<std::uint32_t>& removed);
  void remove_cheap(std::span<const std::uint32_t> vertices, float highest, std::vector<std::uint32_t>& removed);
  void remove_in_blocks(Level& level);
  bool finish(Level level);

  const std::vector<Vec3d>& positions_;
  std::vector<Triangle> triangles_;  // those that are gone keep the vertices that they had
  std::vector<std::uint32_t> twins_;
  std::vector<std::uint32_t> outgoing_;  // per vertex: a halfedge that leaves it, on the border the border's
  std::vector<std::uint8_t> border_;     // per vertex
  std::vector<std::uint32_t> degree_;    // per vertex: neighbours, while levels are made
  std::vector<bool> pinned_;
  std::vector<std::uint32_t> locked_;  // per vertex: 1 + the last level that may not take it
  std::vector<std::uint8_t> gone_;     // per vertex, while levels are made; no bits, which threads could not write apart
  std::vector<Level> levels_;
  std::vector<std::uint32_t> base_;
  VertexBlocks blocks_;
};

}  // namespace curvecast
