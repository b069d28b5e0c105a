// The repaired mesh: manifold, oriented triangles with their halfedge connectivity.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/base/vec.h"

namespace curvecast {

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Halfedge h = 3 f + i of triangle f runs from its corner i to its corner (i + 1) % 3. Connectivity is `twins`, not vertex
/// pairs: after splitting a non-manifold edge, two different edges may join the same two vertices.
struct TriangleMesh {
  std::vector<Vec3d> positions;      // V
  std::vector<Triangle> triangles;   // F, counter-clockwise seen from outside
  std::vector<std::uint32_t> twins;  // 3 F: the opposite halfedge, kNone on a border

  std::size_t vertex_count() const { return positions.size(); }
  std::size_t face_count() const { return triangles.size(); }
  std::uint32_t from(std::uint32_t h) const { return triangles[h / 3][h % 3]; }
  std::uint32_t to(std::uint32_t h) const { return triangles[h / 3][(h + 1) % 3]; }
};

/// A mesh's triangles where they lie, in memory or in a mapped file, which outlives it.
struct MeshView {
  MeshView() = default;
  MeshView(const TriangleMesh& mesh) : positions(mesh.positions), triangles(mesh.triangles) {}  // NOLINT: it is one

  std::span<const Vec3d> positions;
  std::span<const Triangle> triangles;
};

constexpr std::uint32_t next_halfedge(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
constexpr std::uint32_t previous_halfedge(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

/// Normal of a triangle, as long as twice its area.
inline Vec3d area_vector(const Triangle& t, std::span<const Vec3d> positions) {
  const Vec3d& a = positions[t[0]];
  return (positions[t[1]] - a).cross(positions[t[2]] - a);
}
inline Vec3d area_vector(const MeshView& mesh, std::size_t f) { return area_vector(mesh.triangles[f], mesh.positions); }
/// Area of triangle f, in squared units of the file.
double triangle_area(const MeshView& mesh, std::size_t f);
/// Returns the sum of all triangle areas, or of some of them once the context is cancelled.
double surface_area(const TriangleMesh& mesh, const ExecutionContext& context = {});
/// Returns the box of all positions.
Box3d bounding_box(const TriangleMesh& mesh);

}  // namespace curvecast
