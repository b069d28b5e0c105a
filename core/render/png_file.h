// Writes pictures as PNG.
#pragma once

#include <absl/status/statusor.h>

#include <string>

#include "core/base/image.h"

namespace curvecast {

/// Encodes a picture as a PNG file: 8-bit RGB when every pixel is opaque, RGBA otherwise.
/// InvalidArgument when the sides are < 1 or rgba doesn't hold 4 * width * height bytes; Internal with libpng's message.
absl::StatusOr<std::string> encode_png(const Image& image);

}  // namespace curvecast
