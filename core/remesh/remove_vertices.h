// Takes vertices out of a mesh whose other vertices are to stay where they are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/remesh/angle_flips.h"
#include "core/remesh/halfedge_mesh.h"

namespace curvecast {

class VertexRemover {
 public:
  /// Turns all edges of the mesh by their angles. Must not outlive it.
  explicit VertexRemover(HalfedgeMesh& mesh);

  /// Takes vertices out, at most `most` of them, each by moving it onto a neighbour, with edges turned by their angles
  /// throughout. The topology stays. Returns those that are left: they are too many, or the others too few to bear the topology.
  /// Cancelled, and many are left.
  std::vector<std::uint32_t> remove(std::span<const std::uint32_t> vertices, const ExecutionContext& context = {},
                                    std::size_t most = std::numeric_limits<std::size_t>::max());

 private:
  struct Candidate {
    double quality;
    std::uint32_t halfedge;
  };

  bool remove_one(std::uint32_t v, double least);
  bool loosen(std::uint32_t v);
  std::uint32_t best_target(std::uint32_t v, double least);

  HalfedgeMesh& mesh_;
  AngleFlips flips_;
  // Of the vertex that is looked at:
  std::vector<Vec3d> ring_;  // to its neighbours
  std::vector<std::uint32_t> halfedges_;
  std::vector<Candidate> candidates_;
};

}  // namespace curvecast
