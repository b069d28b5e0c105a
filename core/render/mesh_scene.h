// What the passes on OSMesa draw: a checked mesh. Internal to core/render.
#pragma once

#include <absl/status/statusor.h>

#include "core/base/execution_context.h"
#include "core/base/image.h"
#include "core/render/eye_space.h"
#include "core/render/mesh_renderer.h"
#include "core/render/picture_scene.h"

namespace curvecast {

struct MeshScene : PictureScene {
  const MeshSurface& mesh;
  const EyeSpace& space;

  MeshScene(const MeshSurface& of_mesh, const EyeSpace& in_space) : mesh(of_mesh), space(in_space) {}
};

/// Runs the passes. ResourceExhausted when OSMesa has no memory, Internal with its message otherwise; Cancelled.
absl::StatusOr<Image> draw_mesh(const MeshScene& scene, const ExecutionContext& context);

}  // namespace curvecast
