// Components, genus and boundary loops of a manifold mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

struct Topology {
  std::uint32_t components = 0;
  std::uint32_t boundary_loops = 0;              // of all components
  std::uint32_t genus = 0;                       // sum over the components
  std::vector<std::uint32_t> component_of_face;  // F, numbered by first face
};

/// All of these may be wrong once the context is cancelled, and must not be used then.

Topology analyse_topology(const TriangleMesh& mesh, const ExecutionContext& context = {});

/// Labels faces joined by twins with the same number, numbered by first face; returns how many there are.
std::uint32_t label_components(const std::vector<std::uint32_t>& twins, std::vector<std::uint32_t>& component_of_face,
                               const ExecutionContext& context = {});

/// Labels corners (3 F, corner i of face f at 3 f + i) around the same fan of faces with the same number, numbered by first
/// corner; returns how many fans there are. A fan is what a vertex of a manifold mesh is.
std::uint32_t label_fans(const std::vector<std::uint32_t>& twins, std::vector<std::uint32_t>& fan_of_corner,
                         const ExecutionContext& context = {});

/// Returns the border halfedge that follows border halfedge h with the surface on its left.
std::uint32_t next_on_border(std::span<const std::uint32_t> twins, std::uint32_t h);

}  // namespace curvecast
