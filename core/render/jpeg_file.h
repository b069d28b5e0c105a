// Writes pictures as JPEG.
#pragma once

#include <absl/status/statusor.h>

#include <string>

#include "core/base/image.h"

namespace curvecast {

inline constexpr int kUsualJpegQuality = 85;

/// Encodes a picture as a progressive JPEG file, without its alpha. `quality`: 1 to 100; more is sharper and larger, and from 90
/// on colours are as sharp as brightness. InvalidArgument when quality or sides are out of range (1 .. 65,500 pixels) or rgba
/// doesn't hold 4 * width * height bytes; ResourceExhausted; Internal with libturbojpeg's message.
absl::StatusOr<std::string> encode_jpeg(const Image& image, int quality = kUsualJpegQuality);

}  // namespace curvecast
