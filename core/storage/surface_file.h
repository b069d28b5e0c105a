// The flattened mesh as a file: what refining a curve starts from, read only when a curve is to be refined.
#pragma once

#include <absl/status/statusor.h>

#include <string>

#include "core/pipeline/pipeline.h"

namespace curvecast {

/// Grows when what the files hold changes.
inline constexpr std::uint32_t kSurfaceFileVersion = 1;

/// Mesh, attributes with their textures, charts, reports. What follows from the rest (area ratios, curvatures) is left out.
/// Errors as of write_section_file.
absl::Status save_surface(const std::string& path, const FlattenedMesh& surface);

/// Errors as of SectionFile::open, and DataLoss where the content makes no sense: every index, length and number that later
/// stages rely on is checked. Takes memory of the order of the file's size.
absl::StatusOr<FlattenedMesh> load_surface(const std::string& path);

/// Checks that later stages can take the surface. InvalidArgument says what is wrong.
absl::Status check_surface(const FlattenedMesh& surface);

}  // namespace curvecast
