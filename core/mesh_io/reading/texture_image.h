// Decodes the pictures that meshes wear.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <span>

#include "core/base/image.h"

namespace curvecast {

/// Decodes the picture in a PNG, JPEG or WebP file. What the file claims is checked before memory is taken for it.
/// InvalidArgument for other formats and broken files; ResourceExhausted beyond `most_pixels`. Each message is the end of a
/// sentence that begins with the picture's name ("is neither PNG, JPEG nor WebP").
absl::StatusOr<Image> decode_texture(std::span<const char> bytes, std::uint64_t most_pixels);

}  // namespace curvecast
