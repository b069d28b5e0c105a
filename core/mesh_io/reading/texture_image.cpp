#include "core/mesh_io/reading/texture_image.h"

#include <absl/strings/str_format.h>
#include <png.h>
#include <turbojpeg.h>
#include <webp/decode.h>

#include <memory>
#include <string_view>

namespace curvecast {
namespace {

// No picture of so few bytes has more pixels than that.
constexpr std::uint64_t kMostPixelsPerPngByte = 8 * 1032;  // a pixel takes a bit at least, deflate shrinks by 1032 at most
constexpr std::uint64_t kMostPixelsPerJpegByte = 64 * 8;   // a block of 8 x 8 takes a bit at least
// WebP knows no such bound: a picture of one colour takes the same few bytes at any size.
constexpr std::uint64_t kWebpPixelsAnyway = 1 << 24, kMostPixelsPerWebpByte = kMostPixelsPerPngByte;

absl::Status check_size(std::uint64_t width, std::uint64_t height, std::uint64_t most_pixels, std::uint64_t bytes,
                        std::uint64_t most_per_byte, std::uint64_t anyway = 0) {
  if (width < 1 || height < 1) return absl::InvalidArgumentError("has no pixels");
  if (width > most_pixels / height) {
    return absl::ResourceExhaustedError(
        absl::StrFormat("has %d x %d pixels, which is more than the %d that are left for textures", width, height, most_pixels));
  }
  if (width * height <= anyway + most_per_byte * bytes) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("claims %d x %d pixels, more than its %d bytes can hold", width, height, bytes));
}

void allocate(Image& image, std::uint64_t width, std::uint64_t height) {
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
  image.rgba.resize(4 * width * height);
}

absl::StatusOr<Image> decode_png(std::span<const char> bytes, std::uint64_t most_pixels) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  const std::unique_ptr<png_image, void (*)(png_image*)> guard(&png, png_image_free);
  if (png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()) == 0) {
    return absl::InvalidArgumentError(absl::StrFormat("is a broken PNG (%s)", png.message));
  }
  if (absl::Status status = check_size(png.width, png.height, most_pixels, bytes.size(), kMostPixelsPerPngByte); !status.ok()) {
    return status;
  }
  png.format = PNG_FORMAT_RGBA;
  Image image;
  allocate(image, png.width, png.height);
  if (png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr) == 0) {
    return absl::InvalidArgumentError(absl::StrFormat("is a broken PNG (%s)", png.message));
  }
  return image;
}

absl::StatusOr<Image> decode_jpeg(std::span<const char> bytes, std::uint64_t most_pixels) {
  const std::unique_ptr<void, int (*)(void*)> decoder(tjInitDecompress(), tjDestroy);
  if (decoder == nullptr) return absl::ResourceExhaustedError("needs more memory than there is");
  const auto broken = [&] {
    return absl::InvalidArgumentError(absl::StrFormat("is a broken JPEG (%s)", tjGetErrorStr2(decoder.get())));
  };
  const auto* const data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0, height = 0, subsampling = 0, colour_space = 0;
  if (tjDecompressHeader3(decoder.get(), data, bytes.size(), &width, &height, &subsampling, &colour_space) != 0) return broken();
  if (width < 1 || height < 1) return absl::InvalidArgumentError("has no pixels");
  const auto columns = static_cast<std::uint64_t>(width), rows = static_cast<std::uint64_t>(height);
  if (absl::Status status = check_size(columns, rows, most_pixels, bytes.size(), kMostPixelsPerJpegByte); !status.ok()) {
    return status;
  }
  Image image;
  allocate(image, columns, rows);
  // Limited scans: a progressive file could make each of millions of tiny ones go over the whole picture.
  if (tjDecompress2(decoder.get(), data, bytes.size(), image.rgba.data(), width, 0, height, TJPF_RGBA, TJFLAG_LIMITSCANS) != 0 &&
      tjGetErrorCode(decoder.get()) != TJERR_WARNING) {
    return broken();
  }
  return image;
}

absl::StatusOr<Image> decode_webp(std::span<const char> bytes, std::uint64_t most_pixels) {
  const auto* const data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(data, bytes.size(), &features) != VP8_STATUS_OK) return absl::InvalidArgumentError("is a broken WebP");
  if (features.has_animation != 0) return absl::InvalidArgumentError("is an animated WebP");
  const auto width = static_cast<std::uint64_t>(features.width), height = static_cast<std::uint64_t>(features.height);
  if (absl::Status status = check_size(width, height, most_pixels, bytes.size(), kMostPixelsPerWebpByte, kWebpPixelsAnyway);
      !status.ok()) {
    return status;
  }
  Image image;
  allocate(image, width, height);
  if (WebPDecodeRGBAInto(data, bytes.size(), image.rgba.data(), image.rgba.size(), 4 * features.width) == nullptr) {
    return absl::InvalidArgumentError("is a broken WebP");
  }
  return image;
}

}  // namespace

absl::StatusOr<Image> decode_texture(std::span<const char> bytes, std::uint64_t most_pixels) {
  const std::string_view start(bytes.data(), bytes.size());
  if (start.starts_with("\x89PNG\r\n\x1a\n")) return decode_png(bytes, most_pixels);
  if (start.starts_with("\xFF\xD8\xFF")) return decode_jpeg(bytes, most_pixels);
  if (start.starts_with("RIFF") && start.substr(0, 12).ends_with("WEBP")) return decode_webp(bytes, most_pixels);
  return absl::InvalidArgumentError("is neither PNG, JPEG nor WebP");
}

}  // namespace curvecast
