#include "core/mesh/topology.h"

namespace curvecast {
namespace {

std::uint32_t count_boundary_loops(const TriangleMesh& mesh) {
  std::vector<bool> seen(mesh.twins.size(), false);
  std::uint32_t loops = 0;
  for (std::uint32_t start = 0; start < mesh.twins.size(); ++start) {
    if (mesh.twins[start] != kNone || seen[start]) continue;
    ++loops;
    for (std::uint32_t h = start; !seen[h]; h = next_on_border(mesh.twins, h)) seen[h] = true;
  }
  return loops;
}

}  // namespace

std::uint32_t next_on_border(const std::vector<std::uint32_t>& twins, std::uint32_t h) {
  h = next_halfedge(h);
  while (twins[h] != kNone) h = next_halfedge(twins[h]);
  return h;
}

std::uint32_t label_components(const std::vector<std::uint32_t>& twins, std::vector<std::uint32_t>& component_of_face) {
  const std::size_t faces = twins.size() / 3;
  component_of_face.assign(faces, kNone);
  std::vector<std::uint32_t> stack;
  std::uint32_t components = 0;
  for (std::uint32_t seed = 0; seed < faces; ++seed) {
    if (component_of_face[seed] != kNone) continue;
    component_of_face[seed] = components;
    stack.assign(1, seed);
    while (!stack.empty()) {
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

std::uint32_t label_fans(const std::vector<std::uint32_t>& twins, std::vector<std::uint32_t>& fan_of_corner) {
  fan_of_corner.assign(twins.size(), kNone);
  std::uint32_t fans = 0;
  for (std::uint32_t h = 0; h < twins.size(); ++h) {
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
  return fans;
}

Topology analyse_topology(const TriangleMesh& mesh) {
  Topology topology;
  topology.components = label_components(mesh.twins, topology.component_of_face);
  topology.boundary_loops = count_boundary_loops(mesh);
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
