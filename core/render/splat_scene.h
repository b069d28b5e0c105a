// What the passes on OSMesa draw: a checked cloud in eye coordinates. Internal to core/render.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/render/picture_scene.h"

namespace curvecast {

/// One splat as the vertex shader reads it, in eye coordinates: see EyeSpace.
struct SplatVertex {
  std::array<float, 3> center;
  float radius;
  std::array<float, 3> normal;  // unit length, or zero: facing the camera
  std::array<std::uint8_t, 4> color;
  /// The disc is drawn where x p.x + y p.y + z p.z <= w holds for each (x, y, z, w): zeros, everywhere.
  std::array<std::array<float, 4>, 2> ends{};
};

struct DotVertex {
  std::array<float, 3> center;
  std::array<std::uint8_t, 4> color;
};

struct SplatScene : PictureScene {
  std::vector<SplatVertex> splats;
  std::vector<DotVertex> dots;  // none in kSurface
  float dot_diameter = 0;       // pixels
};

/// Runs the passes. ResourceExhausted when OSMesa has no memory, Internal with its message otherwise.
absl::StatusOr<Image> draw_splats(const SplatScene& scene);

}  // namespace curvecast
