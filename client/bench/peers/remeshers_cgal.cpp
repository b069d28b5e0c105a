#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <absl/strings/str_cat.h>

#include <cmath>
#include <exception>
#include <utility>

#include "client/bench/peers/peer_mesh.h"
#include "client/bench/peers/remeshers.h"
#include "core/base/stopwatch.h"

namespace curvecast::cli::bench {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
namespace simplification = CGAL::Surface_mesh_simplification;

Surface to_cgal(const TriangleMesh& mesh) {
  Surface out;
  out.reserve(static_cast<Surface::size_type>(mesh.vertex_count()), static_cast<Surface::size_type>(mesh.twins.size() / 2),
              static_cast<Surface::size_type>(mesh.face_count()));
  for (const Vec3d& p : mesh.positions) out.add_vertex({p.x(), p.y(), p.z()});
  using Vertex = Surface::Vertex_index;
  for (const Triangle& t : mesh.triangles) out.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2]));
  return out;
}

absl::StatusOr<PeerMesh> from_cgal(Surface& surface, double seconds) {
  surface.collect_garbage();
  std::vector<Vec3d> positions;
  for (const auto v : surface.vertices()) {
    const auto& p = surface.point(v);
    positions.emplace_back(p.x(), p.y(), p.z());
  }
  std::vector<Triangle> triangles;
  for (const auto f : surface.faces()) {
    Triangle t{};
    int i = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f))) t[i++] = static_cast<std::uint32_t>(v);
    triangles.push_back(t);
  }
  return make_peer_mesh(std::move(positions), triangles, seconds);
}

/// `work` on a copy of the mesh. Internal: CGAL refuses it.
template <typename Work>
absl::StatusOr<PeerMesh> with_cgal(const TriangleMesh& mesh, const Work& work) try {
  Surface surface = to_cgal(mesh);
  Stopwatch watch;
  work(surface);
  return from_cgal(surface, watch.lap());
} catch (const std::exception& e) {
  return absl::InternalError(absl::StrCat("CGAL: ", e.what()));
}

/// A closed mesh has three edges for each vertex.
simplification::Count_stop_predicate<Surface> edges_of(std::size_t n) {
  return simplification::Count_stop_predicate<Surface>(3 * n);
}

}  // namespace

absl::StatusOr<PeerMesh> remesh_isotropic_cgal(const TriangleMesh& mesh, std::size_t n) {
  constexpr int kRounds = 3;
  // Of equilateral triangles, two for each vertex.
  double length = std::sqrt(2 * surface_area(mesh) / (std::sqrt(3.0) * static_cast<double>(n)));
  const auto remesh = [&](Surface& surface) {
    CGAL::Polygon_mesh_processing::isotropic_remeshing(surface.faces(), length, surface,
                                                       CGAL::parameters::number_of_iterations(kRounds));
  };
  absl::StatusOr<PeerMesh> first = with_cgal(mesh, remesh);
  if (!first.ok()) return first;
  length *= std::sqrt(static_cast<double>(first->mesh.vertex_count()) / static_cast<double>(n));
  return with_cgal(mesh, remesh);
}

absl::StatusOr<PeerMesh> collapse_garland_heckbert_cgal(const TriangleMesh& mesh, std::size_t n) {
  return with_cgal(mesh, [&](Surface& surface) {
    using Policies = simplification::GarlandHeckbert_plane_policies<Surface, Kernel>;
    const Policies policies(surface);
    simplification::edge_collapse(surface, edges_of(n),
                                  CGAL::parameters::get_cost(policies.get_cost()).get_placement(policies.get_placement()));
  });
}

absl::StatusOr<PeerMesh> collapse_lindstrom_turk_cgal(const TriangleMesh& mesh, std::size_t n) {
  return with_cgal(mesh, [&](Surface& surface) {
    simplification::edge_collapse(surface, edges_of(n),
                                  CGAL::parameters::get_cost(simplification::LindstromTurk_cost<Surface>())
                                      .get_placement(simplification::LindstromTurk_placement<Surface>()));
  });
}

}  // namespace curvecast::cli::bench
