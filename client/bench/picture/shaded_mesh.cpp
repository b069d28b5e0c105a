#include "client/bench/picture/shaded_mesh.h"

#include <utility>

#include "core/curve/place_attributes.h"
#include "core/render/mesh_renderer.h"

namespace curvecast::cli::bench {

ShadedMesh::ShadedMesh(LoadedMesh loaded, std::optional<double> crease_degrees)
    : loaded_(std::move(loaded)),
      geometry_(differential_geometry(loaded_.mesh)),
      crease_degrees_(curvecast::crease_degrees({.crease_degrees = crease_degrees}, loaded_.info.crease_degrees)),
      creases_(crease_normals(loaded_.mesh, crease_degrees_)),
      colour_(has_colour(loaded_.attributes) ? std::make_unique<const SurfaceColour>(loaded_.mesh, loaded_.attributes) : nullptr),
      data_(loaded_.mesh, geometry_, creases_, loaded_.attributes, colour_.get()) {}

absl::StatusOr<Image> ShadedMesh::draw(const RenderCamera& camera, const RenderOptions& options,
                                       const ExecutionContext& context) const {
  const auto look = [this](std::uint32_t face, const Vec3f& weights, double area) {
    SurfaceLook here{normal_at(data_, face, {weights[1], weights[2]}), {}};
    if (colour_ == nullptr) return here;
    const Rgba8 colour = colour_->at(face, weights, area);
    here.color = {colour.r, colour.g, colour.b};
    return here;
  };
  return render_mesh({mesh().positions, mesh().triangles, look, has_colours()}, camera, options, context);
}

}  // namespace curvecast::cli::bench
