// Draws a triangle mesh as the surface that pictures of its points stand for, in software (OSMesa): to hold those against.
//
// The triangles are drawn as numbers; what is seen of a triangle at each sample is then computed from itself (deferred shading:
// Deering, Winner, Schediwy, Duffy, Hunt, "The Triangle Processor and Normal Vector Shader", SIGGRAPH 1988). Occlusion, light,
// background and what becomes of backs are those of render_splats(): with more and more points, its pictures become these.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <functional>
#include <span>

#include "core/base/execution_context.h"
#include "core/base/image.h"
#include "core/base/vec.h"
#include "core/render/render_camera.h"
#include "core/render/splat_renderer.h"

namespace curvecast {

/// What a place on the surface looks like.
struct SurfaceLook {
  Vec3f normal;  // any length; zero: it faces the camera
  Rgb8 color;
};

/// A mesh where it lies: nothing of it is copied as a whole.
struct MeshSurface {
  std::span<const Vec3d> positions;     // mesh units, finite
  std::span<const Triangle> triangles;  // of positions; fewer than 2^32 - 1
  /// Returns how the face looks at a place. `weights`: barycentric, of its corners. `area`: of the surface, in squared mesh
  /// units, that the answer stands for. Called by several threads at once.
  std::function<SurfaceLook(std::uint32_t face, const Vec3f& weights, double area)> look;
  bool has_colors = false;  // else those that look() returns do not count
};

/// Of the options, those count that are not about splats and dots; the style is kSurface. Where `options.supersample` has a pixel
/// of s x s samples, each sees one place. Takes 40 bytes of memory per sample, and 40 MB, however large the mesh is.
///
/// InvalidArgument for a mesh without triangles, options out of range or a camera as for render_splats(); ResourceExhausted or
/// Internal when OSMesa refuses; Cancelled. Deterministic on one machine. May be called from any thread; leaves no OSMesa context
/// current on it.
absl::StatusOr<Image> render_mesh(const MeshSurface& mesh, const RenderCamera& camera, const RenderOptions& options = {},
                                  const ExecutionContext& context = {});

}  // namespace curvecast
