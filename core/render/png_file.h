// Writes pictures as PNG.
#pragma once

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include <filesystem>
#include <string>

#include "core/base/image.h"

namespace curvecast {

/// The bytes of a PNG file: 8-bit RGB when every pixel is opaque, RGBA otherwise.
/// InvalidArgument when the sides are < 1 or rgba doesn't hold 4 * width * height bytes; Internal with libpng's message.
absl::StatusOr<std::string> encode_png(const Image& image);

/// Writes beside `path` under a temporary name and renames: `path` is never a half-written file. Errors as for encode_png, and
/// NotFound, PermissionDenied and the like with the path and the system's message.
absl::Status write_png(const std::filesystem::path& path, const Image& image);

}  // namespace curvecast
