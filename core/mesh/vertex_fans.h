// The faces around each vertex of a manifold mesh, found through its halfedges.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/execution_context.h"
#include "core/base/for_all.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// Must not outlive its mesh. Precondition: the faces around a vertex form one fan, as repair() leaves them. Of some vertices
/// none are known once the context is cancelled.
class VertexFans {
 public:
  explicit VertexFans(const TriangleMesh& mesh, const ExecutionContext& context = {})
      : mesh_(mesh), first_(mesh.vertex_count(), kNone) {
    constexpr std::size_t kBlock = 1 << 18;
    // On a border the fan has an end to start from: the halfedge that leaves along it.
    for_blocks_in_turn(context, mesh.twins.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
        std::uint32_t& first = first_[mesh.from(h)];
        if (first == kNone || mesh.twins[h] == kNone) first = h;
      }
    });
  }

  bool on_border(std::size_t v) const { return first_[v] == kNone || mesh_.twins[first_[v]] == kNone; }

  /// A halfedge that leaves v, along the border where it is there; kNone: no face has v.
  std::uint32_t outgoing(std::uint32_t v) const { return first_[v]; }

  /// Calls `visit` with the halfedges that leave v, counter-clockwise: one for each face of its fan.
  template <typename Visit>
  void visit(std::size_t v, Visit&& visit) const {
    std::uint32_t h = first_[v];
    while (h != kNone) {
      visit(h);
      h = mesh_.twins[previous_halfedge(h)];
      if (h == first_[v]) break;
    }
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<std::uint32_t> first_;
};

}  // namespace curvecast
