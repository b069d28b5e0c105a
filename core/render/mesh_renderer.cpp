#include "core/render/mesh_renderer.h"

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <limits>
#include <new>

#include "core/base/for_all.h"
#include "core/render/mesh_scene.h"

namespace curvecast {
namespace {

constexpr std::size_t kInTurn = 1 << 20;  // positions between two looks whether the work was cancelled

Box3d box_of(std::span<const Vec3d> positions, const ExecutionContext& context) {
  Box3d box;
  for_blocks_in_turn(context, positions.size(), kInTurn, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) box.extend(positions[i]);
  });
  return box;
}

/// Between which distances all of a box lies.
void set_depths(const Box3d& box, const EyeSpace& space, PictureScene& scene) {
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const auto side = [&](int axis) { return (corner >> axis & 1) != 0 ? box.max[axis] : box.min[axis]; };
    const double depth = -space.place({side(0), side(1), side(2)}).z();
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  scene.set_depths(nearest, farthest);
}

}  // namespace

absl::StatusOr<Image> render_mesh(const MeshSurface& mesh, const RenderCamera& camera, const RenderOptions& options,
                                  const ExecutionContext& context) {
  if (absl::Status status = check_picture_size(options); !status.ok()) return status;
  if (mesh.triangles.empty()) return absl::InvalidArgumentError("cannot render a mesh without triangles");
  if (mesh.triangles.size() >= std::numeric_limits<std::uint32_t>::max()) {
    return absl::InvalidArgumentError(absl::StrFormat("cannot render %d triangles: at most 2^32 - 2", mesh.triangles.size()));
  }
  const Box3d box = box_of(mesh.positions, context);
  if (absl::Status status = context.check(); !status.ok()) return status;
  const absl::StatusOr<EyeSpace> space = EyeSpace::make(camera, box);
  if (!space.ok()) return space.status();
  try {
    MeshScene scene(mesh, *space);
    set_up(options, camera, scene);
    set_depths(box, *space, scene);
    scene.has_normals = true;
    scene.has_colors = mesh.has_colors;
    return draw_mesh(scene, context);
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrFormat("out of memory while rendering %d triangles on %d x %d pixels",
                                                        mesh.triangles.size(), options.width, options.height));
  }
}

}  // namespace curvecast
