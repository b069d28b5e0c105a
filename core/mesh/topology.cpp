#include "core/mesh/topology.h"

#include "core/base/for_all.h"

namespace curvecast {
namespace {

constexpr std::size_t kBlock = 1 << 18;  // faces or corners between two looks whether the work was cancelled

std::uint32_t count_boundary_loops(const TriangleMesh& mesh, const ExecutionContext& context) {
  std::vector<bool> seen(mesh.twins.size(), false);
  std::uint32_t loops = 0;
  for_blocks_in_turn(context, mesh.twins.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (auto start = static_cast<std::uint32_t>(begin); start < end; ++start) {
      if (mesh.twins[start] != kNone || seen[start]) continue;
      ++loops;
      for (std::uint32_t h = start; !seen[h]; h = next_on_border(mesh.twins, h)) seen[h] = true;
    }
  });
  return loops;
}

}  // namespace

std::uint32_t next_on_border(std::span<const std::uint32_t> twins, std::uint32_t h) {
  h = next_halfedge(h);
  while (twins[h] != kNone) h = next_halfedge(twins[h]);
  return h;
}

std::uint32_t label_components(const std::vector<std::uint32_t>& twins, std::vector<std::uint32_t>& component_of_face,
                               const ExecutionContext& context) {
  const std::size_t faces = twins.size() / 3;
  component_of_face.assign(faces, kNone);
  std::vector<std::uint32_t> stack;
  std::uint32_t components = 0;
  for (std::uint32_t seed = 0; seed < faces; ++seed) {
    if (component_of_face[seed] != kNone) continue;
    component_of_face[seed] = components;
    stack.assign(1, seed);
    for (std::size_t steps = 0; !stack.empty(); ++steps) {
      if (steps % kBlock == 0 && context.cancelled()) return components;
      const std::uint32_t f = stack.back();
      stack.pop_back();
      for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
        const std::uint32_t t = twins[h];
        if (t == kNone || component_of_face[t / 3] != kNone) continue;
        component_of_face[t / 3] = components;
        stack.push_back(t / 3);
      }
    }
    ++components;
  }
  return components;
}

std::uint32_t label_fans(const std::vector<std::uint32_t>& twins, std::vector<std::uint32_t>& fan_of_corner,
                         const ExecutionContext& context) {
  fan_of_corner.assign(twins.size(), kNone);
  std::uint32_t fans = 0;
  for_blocks_in_turn(context, twins.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
      if (fan_of_corner[h] != kNone) continue;
      std::uint32_t out = h;  // halfedges that leave the vertex, counter-clockwise
      do {
        fan_of_corner[out] = fans;
        out = twins[previous_halfedge(out)];
      } while (out != kNone && out != h);
      if (out == kNone) {
        for (std::uint32_t in = twins[h]; in != kNone; in = twins[next_halfedge(in)]) fan_of_corner[next_halfedge(in)] = fans;
      }
      ++fans;
    }
  });
  return fans;
}

Topology analyse_topology(const TriangleMesh& mesh, const ExecutionContext& context) {
  Topology topology;
  topology.components = label_components(mesh.twins, topology.component_of_face, context);
  topology.boundary_loops = count_boundary_loops(mesh, context);
  std::size_t borders = 0;
  for (const std::uint32_t t : mesh.twins) borders += t == kNone;
  // Euler's formula summed over the components: V - E + F = 2 C - 2 g - b.
  const auto vertices = static_cast<std::int64_t>(mesh.vertex_count());
  const auto edges = static_cast<std::int64_t>((mesh.twins.size() + borders) / 2);
  const auto faces = static_cast<std::int64_t>(mesh.face_count());
  const std::int64_t twice_genus = 2 * static_cast<std::int64_t>(topology.components) -
                                   static_cast<std::int64_t>(topology.boundary_loops) - (vertices - edges + faces);
  topology.genus = static_cast<std::uint32_t>(twice_genus / 2);
  return topology;
}

}  // namespace curvecast
