#include "core/render/png_file.h"

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <png.h>

#include <cstdint>
#include <new>
#include <vector>

namespace curvecast {
namespace {

/// The red, green and blue of every pixel.
std::vector<std::uint8_t> without_alpha(const std::vector<std::uint8_t>& rgba) {
  std::vector<std::uint8_t> rgb(rgba.size() / 4 * 3);
  for (std::size_t from = 0, to = 0; from < rgba.size(); from += 4, to += 3) {
    for (std::size_t k = 0; k < 3; ++k) rgb[to + k] = rgba[from + k];
  }
  return rgb;
}

absl::StatusOr<std::string> encode(const Image& image, png_uint_32 format, const std::vector<std::uint8_t>& pixels) {
  png_image writer = {};
  writer.version = PNG_IMAGE_VERSION;
  writer.width = static_cast<png_uint_32>(image.width);
  writer.height = static_cast<png_uint_32>(image.height);
  writer.format = format;
  std::string bytes;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(writer);
  bytes.resize(size);
  if (png_image_write_to_memory(&writer, bytes.data(), &size, 0, pixels.data(), 0, nullptr) == 0) {
    const std::string message = writer.message;
    png_image_free(&writer);
    return absl::InternalError(absl::StrCat("libpng: ", message));
  }
  bytes.resize(size);
  bytes.shrink_to_fit();
  return bytes;
}

}  // namespace

absl::StatusOr<std::string> encode_png(const Image& image) {
  // libpng's own default bound for both sides.
  constexpr int kMaxSide = 1'000'000;
  if (image.width < 1 || image.height < 1 || image.width > kMaxSide || image.height > kMaxSide) {
    return absl::InvalidArgumentError(
        absl::StrFormat("cannot write a PNG of %d x %d pixels: each side must be 1 .. %d", image.width, image.height, kMaxSide));
  }
  const std::size_t expected = 4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.rgba.size() != expected) {
    return absl::InvalidArgumentError(absl::StrFormat("an image of %d x %d pixels needs %d bytes of RGBA, not %d", image.width,
                                                      image.height, expected, image.rgba.size()));
  }
  bool opaque = true;
  for (std::size_t i = 3; i < expected && opaque; i += 4) opaque = image.rgba[i] == 255;
  try {
    return opaque ? encode(image, PNG_FORMAT_RGB, without_alpha(image.rgba)) : encode(image, PNG_FORMAT_RGBA, image.rgba);
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("out of memory while encoding a PNG");
  }
}

}  // namespace curvecast
