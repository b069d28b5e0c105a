// Shortest paths along the edges of a mesh, grown from a changing set of sources.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// Distances from the nearest source, kept up to date as sources are added. Not thread-safe.
class EdgePaths {
 public:
  /// Keeps a reference to the mesh.
  explicit EdgePaths(const TriangleMesh& mesh);

  /// Makes the vertices sources (distance 0, no parent) and lowers the distances around them.
  void add_sources(std::span<const std::uint32_t> vertices);
  /// As above, but only as far as it takes to know the paths of the targets, the only vertices that may be asked for from now on
  /// until clear(). Source: A* search of Hart, Nilsson, Raphael (1968), straight lines being no longer than paths.
  void add_sources(std::span<const std::uint32_t> vertices, std::span<const std::uint32_t> targets);
  /// Forgets all sources.
  void clear();

  /// Length of the shortest path from v to a source, in the mesh's units; infinite where there is none.
  double distance(std::uint32_t v) const { return distance_[v]; }
  /// Returns a halfedge between v and the next vertex of its path; kNone at a source.
  std::uint32_t parent_edge(std::uint32_t v) const { return parent_[v]; }
  /// Returns the next vertex of v's path. Precondition: v is not a source.
  std::uint32_t parent(std::uint32_t v) const;
  /// Returns the source at the end of v's path.
  std::uint32_t source(std::uint32_t v) const;
  /// Returns the vertex with the largest finite distance; the first of several.
  std::uint32_t farthest() const;
  /// Finds the vertex farthest from v, which becomes the only source.
  std::uint32_t farthest_from(std::uint32_t v);

 private:
  template <typename Left, typename IsOver>
  void grow(std::span<const std::uint32_t> sources, const Left& left, const IsOver& is_over);

  const TriangleMesh& mesh_;
  std::vector<std::uint32_t> begin_;      // V + 1 offsets into halfedges_
  std::vector<std::uint32_t> halfedges_;  // one halfedge of every edge at the vertex
  std::vector<double> distance_;
  std::vector<std::uint32_t> parent_;
};

}  // namespace curvecast
