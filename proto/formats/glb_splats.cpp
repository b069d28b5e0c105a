// SPDX-License-Identifier: Apache-2.0
#include "proto/formats/glb_splats.h"

#include <utility>
#include <vector>

#include "proto/formats/append_value.h"
#include "proto/formats/glb_file.h"

namespace curvecast::formats {
namespace {

GlbAttribute floats(const char* semantic, int count) {
  return {.semantic = semantic, .count = count, .stride = static_cast<std::size_t>(count) * sizeof(float)};
}

}  // namespace

absl::StatusOr<std::string> make_glb_splats(const PointColumns& columns) {
  const absl::StatusOr<Splats> splats = make_splats(columns);
  if (!splats.ok()) return splats.status();
  GlbPoints points{.size = splats->size(), .translation = splats->origin, .splats = true};
  if (points.size == 0) return make_glb_file(points);  // which says that there are none
  GlbAttribute positions = floats("POSITION", 3);
  const Box box = box_of(splats->positions);
  positions.low.assign(box.low.begin(), box.low.end());
  positions.high.assign(box.high.begin(), box.high.end());
  GlbAttribute rotations = floats("KHR_gaussian_splatting:ROTATION", 4);
  GlbAttribute scales = floats("KHR_gaussian_splatting:SCALE", 3);
  GlbAttribute opacities = floats("KHR_gaussian_splatting:OPACITY", 1);
  GlbAttribute harmonics = floats("KHR_gaussian_splatting:SH_DEGREE_0_COEF_0", 3);
  for (std::size_t i = 0; i < points.size; ++i) {
    append_value(positions.bytes, splats->positions[i]);
    append_value(rotations.bytes, splats->rotations[i]);
    const float width = splats->widths[i];
    append_value(scales.bytes, std::array<float, 3>{width, width, width * kSplatThickness});
    append_value(opacities.bytes, kSplatOpacity);
    for (const std::uint8_t channel : splats->colours[i]) append_value(harmonics.bytes, harmonic_of(channel));
  }
  points.attributes = {std::move(positions), std::move(rotations), std::move(scales), std::move(opacities), std::move(harmonics),
                       colour_attribute(splats->colours, double{kSplatOpacity})};
  return make_glb_file(points);
}

}  // namespace curvecast::formats
