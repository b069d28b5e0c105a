#include "core/render/jpeg_file.h"

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <turbojpeg.h>

#include <memory>
#include <new>

namespace curvecast {
namespace {

constexpr int kMaxSide = 65'500;   // libjpeg's own bound
constexpr int kSharpColours = 90;  // the lowest quality with a colour for every pixel

}  // namespace

absl::StatusOr<std::string> encode_jpeg(const Image& image, int quality) {
  if (quality < 1 || quality > 100) {
    return absl::InvalidArgumentError(absl::StrCat("the quality of a JPEG is 1 .. 100, not ", quality));
  }
  if (image.width < 1 || image.height < 1 || image.width > kMaxSide || image.height > kMaxSide) {
    return absl::InvalidArgumentError(
        absl::StrFormat("cannot write a JPEG of %d x %d pixels: each side must be 1 .. %d", image.width, image.height, kMaxSide));
  }
  const std::size_t expected = 4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.rgba.size() != expected) {
    return absl::InvalidArgumentError(absl::StrFormat("an image of %d x %d pixels needs %d bytes of RGBA, not %d", image.width,
                                                      image.height, expected, image.rgba.size()));
  }
  const std::unique_ptr<void, int (*)(void*)> encoder(tjInitCompress(), tjDestroy);
  if (encoder == nullptr) return absl::ResourceExhaustedError("out of memory while encoding a JPEG");
  unsigned char* file = nullptr;
  unsigned long size = 0;
  const int failed = tjCompress2(encoder.get(), image.rgba.data(), image.width, 0, image.height, TJPF_RGBX, &file, &size,
                                 quality < kSharpColours ? TJSAMP_420 : TJSAMP_444, quality, TJFLAG_PROGRESSIVE);
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owner(file, tjFree);
  if (failed != 0) return absl::InternalError(absl::StrCat("libturbojpeg: ", tjGetErrorStr2(encoder.get())));
  try {
    return std::string(reinterpret_cast<const char*>(file), size);
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("out of memory while encoding a JPEG");
  }
}

}  // namespace curvecast
