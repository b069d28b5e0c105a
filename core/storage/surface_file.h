// What a curve lies on as a file, used where it lies: refinement and places within leaves read only the charts that they need.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "core/curve/curve_base.h"

namespace curvecast {

/// Grows when what the files hold changes.
inline constexpr std::uint32_t kSurfaceFileVersion = 4;

/// Mesh, geometry, creases, what gives colour with its textures, charts. `note` says whose it is. Errors as of
/// write_section_file.
absl::Status save_surface(const std::string& path, const CurveBase& surface, std::string_view note = {});

/// Opens a surface, in a time that depends on its textures and creases alone: the rest is mapped, and what a chart needs is
/// checked when the chart is first asked for, every byte, and every index, length and number that later stages rely on. What is
/// returned keeps the file. Errors as of SectionFile::open, and DataLoss where the content makes no sense or was saved with
/// another note; those of charts come from CurveBase::status(), and on_damage is told, by the thread that asked.
absl::StatusOr<std::shared_ptr<const CurveBase>> open_surface(const std::string& path, std::string_view note = {},
                                                              std::function<void(const absl::Status&)> on_damage = {});

/// Reads all of such a file. OK where every byte is as it was saved; errors as of SectionFile::open.
absl::Status check_surface_file(const std::string& path);

}  // namespace curvecast
