// What `render` draws in space: a surface of splats, and dots or lines on it.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "client/cli/common.h"
#include "client/cli/sample_flags.h"
#include "client/cli/session_flags.h"
#include "core/base/image.h"
#include "core/render/splat_renderer.h"

namespace curvecast::cli {

struct RenderFlags {
  std::string input, output, size = "1280x960", what = "surface", style = "surface";
  bool no_colour = false, with_mesh = false;
  SampleFlags sample;
  SessionFlags session;
};

struct Size {
  int width = 0, height = 0;  // pixels
  double aspect() const { return static_cast<double>(width) / height; }
};

struct Scene {
  client::Points cloud;            // the surface
  std::vector<Vec3f> dots;         // on it, relative to the cloud's origin; none: with kDots, the cloud's own points
  std::vector<Rgb8> dot_colours;   // one for each dot, or none
  double crease_degrees = 40;      // as of SplatCloud
  v1::Camera camera;               // absolute coordinates
  RenderOptions options;           // all but the size
  std::string counted = "points";  // what `count` counts
  std::uint64_t count = 0;
};

/// Returns a picture's own camera, absolute.
absl::StatusOr<v1::Camera> camera_of(const SampleFlags& flags, const Box3d& box, const Size& size);

/// The points of a file.
absl::StatusOr<Scene> load_scene(const RenderFlags& flags, const Size& size);

/// What flags.what says of a mesh: surface, samples, mesh, cut or surface-curve.
absl::StatusOr<Scene> make_scene(const RenderFlags& flags, const CommonOptions& options, const Size& size, std::stop_token stop);

/// In coordinates relative to `origin`.
RenderCamera to_render_camera(const v1::Camera& camera, const Vec3d& origin);

absl::StatusOr<Image> draw_scene(const Scene& scene, const Size& size);

/// The options of the session whose curve --what curve and surface-curve show.
absl::StatusOr<v1::SessionOptions> curve_session_options(const RenderFlags& flags);

}  // namespace curvecast::cli
