#include "core/pipeline/curve_surface.h"

#include <optional>
#include <utility>

#include "core/curve/surface_colour.h"

namespace curvecast {
namespace {

struct OwnedBase {
  OwnedBase(std::shared_ptr<const FlattenedMesh> mesh, const ExecutionContext& context) : flattened(std::move(mesh)) {
    const LoadedMesh& loaded = flattened->loaded;
    if (has_colour(loaded.attributes)) colour.emplace(loaded.mesh, loaded.attributes);
    SurfaceData data(loaded.mesh, flattened->geometry, flattened->creases, loaded.attributes, colour ? &*colour : nullptr);
    data.borders = flattened->borders;
    base.emplace(std::move(data), flattened->charts, context);
  }
  OwnedBase(const OwnedBase&) = delete;

  std::shared_ptr<const FlattenedMesh> flattened;
  std::optional<SurfaceColour> colour;
  std::optional<CurveBase> base;
};

}  // namespace

absl::StatusOr<std::shared_ptr<const CurveBase>> curve_base(std::shared_ptr<const FlattenedMesh> flattened,
                                                            const ExecutionContext& context) {
  const auto owned = std::make_shared<const OwnedBase>(std::move(flattened), context);
  if (absl::Status status = context.check(); !status.ok()) return status;
  return std::shared_ptr<const CurveBase>(owned, &*owned->base);
}

std::shared_ptr<const LeafSurface> leaf_surface(const Preprocessed& preprocessed) {
  return std::make_shared<const LeafSurface>(*curve_base(preprocessed.flattened), preprocessed.curve);
}

}  // namespace curvecast
