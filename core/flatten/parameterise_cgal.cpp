#include "core/flatten/parameterise_cgal.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <CGAL/Eigen_solver_traits.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_parameterization/Mean_value_coordinates_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/Square_border_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/parameterize.h>

#include <exception>
#include <new>

#include "core/base/stopwatch.h"
#include "core/flatten/watched_preconditioner.h"

namespace curvecast {
namespace {

namespace smp = CGAL::Surface_mesh_parameterization;

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Vertex = Mesh::Vertex_index;
using Halfedge = Mesh::Halfedge_index;
using UvMap = Mesh::Property_map<Vertex, Kernel::Point_2>;
using Border = smp::Square_border_arc_length_parameterizer_3<Mesh>;
using Matrix = CGAL::Eigen_sparse_matrix<double>::EigenType;

/// CGAL's parameteriser, which looks while it makes the matrix whether it shall go on.
template <typename Preconditioner>
class WatchedParameteriser : public smp::Mean_value_coordinates_parameterizer_3<
                                 Mesh, Border, CGAL::Eigen_solver_traits<Eigen::BiCGSTAB<Matrix, Watched<Preconditioner>>>> {
  double compute_w_ij(const Mesh& mesh, Vertex v, CGAL::Vertex_around_target_circulator<Mesh> neighbour) const override {
    WatchedContext::end_if_cancelled();
    return WatchedParameteriser::Mean_value_coordinates_parameterizer_3::compute_w_ij(mesh, v, neighbour);
  }
};

/// Vertices keep their numbers.
absl::StatusOr<Mesh> to_cgal(const DiscMesh& disc) {
  Mesh mesh;
  mesh.reserve(static_cast<Mesh::size_type>(disc.vertex_count()),
               static_cast<Mesh::size_type>(disc.vertex_count() + disc.triangles.size()),
               static_cast<Mesh::size_type>(disc.triangles.size()));
  for (const Vec3d& p : disc.positions) mesh.add_vertex({p.x(), p.y(), p.z()});
  for (std::size_t t = 0; t < disc.triangles.size(); ++t) {
    WatchedContext::end_if_cancelled();
    const auto& [a, b, c] = disc.triangles[t];
    if (mesh.add_face(Vertex(a), Vertex(b), Vertex(c)) == Mesh::null_face()) {
      return absl::InvalidArgumentError(
          absl::StrFormat("CGAL refuses triangle %d (%d, %d, %d) of the disc: it would not be manifold", t, a, b, c));
    }
  }
  return mesh;
}

template <typename Preconditioner>
smp::Error_code solve(Mesh& mesh, Halfedge border, const UvMap& uv) {
  return smp::parameterize(mesh, WatchedParameteriser<Preconditioner>(), border, uv);
}

absl::StatusOr<std::vector<Vec2d>> run(const DiscMesh& disc, CgalPreconditioner preconditioner, double* solve_seconds,
                                       const ExecutionContext& context) {
  const WatchedContext watched(context);
  if (disc.border.size() < 4) return absl::InvalidArgumentError("the disc's border has fewer than four vertices");
  absl::StatusOr<Mesh> mesh = to_cgal(disc);
  if (!mesh.ok()) return mesh.status();
  // CGAL goes around the hole, against our sense.
  const Halfedge border = mesh->halfedge(Vertex(disc.border.front()), Vertex(disc.border.back()));
  if (!border.is_valid() || !mesh->is_border(border)) return absl::InvalidArgumentError("the disc's border is none to CGAL");
  const UvMap uv = mesh->add_property_map<Vertex, Kernel::Point_2>("v:uv").first;
  Stopwatch watch;
  const smp::Error_code code = preconditioner == CgalPreconditioner::kDiagonal
                                   ? solve<Eigen::DiagonalPreconditioner<double>>(*mesh, border, uv)
                                   : solve<Eigen::IncompleteLUT<double>>(*mesh, border, uv);
  if (solve_seconds != nullptr) *solve_seconds = watch.lap();
  if (code != smp::OK) return absl::InternalError(absl::StrCat("CGAL's parameteriser: ", smp::get_error_message(code)));
  std::vector<Vec2d> result;
  result.reserve(disc.vertex_count());
  // Mirrored, because of the sense. One vertex for two corners makes CGAL leave the square.
  for (const Vertex v : mesh->vertices()) {
    const Vec2d p(uv[v].y(), uv[v].x());
    if (!(p.minCoeff() >= 0 && p.maxCoeff() <= 1)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("CGAL's parameteriser puts vertex %d at (%g, %g), outside of the square", v.idx(), p.x(), p.y()));
    }
    result.push_back(p);
  }
  return result;
}

}  // namespace

absl::StatusOr<std::vector<Vec2d>> parameterise_cgal(const DiscMesh& disc, CgalPreconditioner preconditioner,
                                                     double* solve_seconds, const ExecutionContext& context) {
  try {
    return run(disc, preconditioner, solve_seconds, context);
  } catch (const Cancelled&) {
    return absl::CancelledError("cancelled");
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("not enough memory for CGAL's parameteriser");
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("CGAL's parameteriser: ", error.what()));
  }
}

}  // namespace curvecast
