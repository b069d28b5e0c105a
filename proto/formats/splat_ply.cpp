// SPDX-License-Identifier: Apache-2.0
#include "proto/formats/splat_ply.h"

#include <absl/strings/str_format.h>

#include <cmath>

#include "proto/formats/append_value.h"

namespace curvecast::formats {

absl::StatusOr<std::string> make_splat_ply(const PointColumns& columns) {
  const absl::StatusOr<Splats> splats = make_splats(columns);
  if (!splats.ok()) return splats.status();
  std::string out = "ply\nformat binary_little_endian 1.0\n";
  if (const auto& [x, y, z] = splats->origin; splats->origin != std::array<double, 3>{}) {
    absl::StrAppendFormat(&out, "comment origin %.17g %.17g %.17g\n", x, y, z);
  }
  absl::StrAppendFormat(&out, "element vertex %d\n", splats->size());
  constexpr std::array kProperties = {"x",       "y",       "z",       "nx",    "ny",    "nz",    "f_dc_0", "f_dc_1", "f_dc_2",
                                      "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2",  "rot_3"};
  for (const char* property : kProperties) absl::StrAppendFormat(&out, "property float %s\n", property);
  out += "end_header\n";
  out.reserve(out.size() + splats->size() * kProperties.size() * sizeof(float));
  const float opacity = std::log(kSplatOpacity / (1 - kSplatOpacity));
  for (std::size_t i = 0; i < splats->size(); ++i) {
    append_value(out, splats->positions[i]);
    append_value(out, splats->normals[i]);
    for (const std::uint8_t channel : splats->colours[i]) append_value(out, harmonic_of(channel));
    append_value(out, opacity);
    const float scale = std::log(splats->widths[i]);
    append_value(out, std::array<float, 3>{scale, scale, std::log(splats->widths[i] * kSplatThickness)});
    const auto& [x, y, z, w] = splats->rotations[i];
    append_value(out, std::array<float, 4>{w, x, y, z});
  }
  return out;
}

}  // namespace curvecast::formats
