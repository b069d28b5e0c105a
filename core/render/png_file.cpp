#include "core/render/png_file.h"

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <fcntl.h>
#include <png.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csetjmp>
#include <limits>
#include <new>

namespace curvecast {
namespace {

// What libpng's callbacks see. They must not throw through C frames, so failures are kept here.
struct Sink {
  std::string bytes;
  std::string message;
};

void append(png_structp png, png_bytep data, std::size_t size) {
  auto* sink = static_cast<Sink*>(png_get_io_ptr(png));
  try {
    sink->bytes.append(reinterpret_cast<const char*>(data), size);
  } catch (const std::bad_alloc&) {
    png_error(png, "out of memory");
  }
}

void flush(png_structp) {}

[[noreturn]] void fail(png_structp png, png_const_charp message) {
  static_cast<Sink*>(png_get_error_ptr(png))->message = message;
  png_longjmp(png, 1);
}

void warn(png_structp, png_const_charp) {}

// Plain data only between setjmp and longjmp: no destructor may be skipped. `row` holds one row without alpha.
bool encode_rows(const Image& image, bool opaque, png_bytep row, Sink& sink) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &sink, fail, warn);
  if (png == nullptr) return false;
  png_infop info = png_create_info_struct(png);
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, &sink, append, flush);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8,
               opaque ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGB_ALPHA, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(png, info);
  const std::size_t width = static_cast<std::size_t>(image.width);
  for (int y = 0; y < image.height; ++y) {
    png_const_bytep source = image.rgba.data() + 4 * width * static_cast<std::size_t>(y);
    if (opaque) {
      for (std::size_t x = 0; x < width; ++x) std::copy_n(source + 4 * x, 3, row + 3 * x);
      source = row;
    }
    png_write_row(png, source);
  }
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return true;
}

absl::Status write_bytes(const std::string& path, const std::string& bytes) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) return absl::ErrnoToStatus(errno, absl::StrCat("cannot create ", path));
  absl::Status status;
  for (std::size_t done = 0; done < bytes.size() && status.ok();) {
    const ssize_t n = ::write(file, bytes.data() + done, bytes.size() - done);
    if (n >= 0) {
      done += static_cast<std::size_t>(n);
    } else if (errno != EINTR) {
      status = absl::ErrnoToStatus(errno, absl::StrCat("cannot write ", path));
    }
  }
  // The disk's last words (quota, network) come at close.
  if (::close(file) != 0 && status.ok()) status = absl::ErrnoToStatus(errno, absl::StrCat("cannot close ", path));
  return status;
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
    Sink sink;
    std::vector<png_byte> row(3 * static_cast<std::size_t>(image.width));
    if (!encode_rows(image, opaque, row.data(), sink)) {
      return absl::InternalError(absl::StrCat("libpng: ", sink.message.empty() ? "out of memory" : sink.message));
    }
    return std::move(sink.bytes);
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("out of memory while encoding a PNG");
  }
}

absl::Status write_png(const std::filesystem::path& path, const Image& image) {
  absl::StatusOr<std::string> bytes = encode_png(image);
  if (!bytes.ok()) return bytes.status();
  const std::string target = path.string();
  const std::string temporary = absl::StrCat(target, ".", ::getpid(), ".", ::gettid(), ".tmp");
  absl::Status status = write_bytes(temporary, *bytes);
  if (status.ok() && ::rename(temporary.c_str(), target.c_str()) != 0) {
    status = absl::ErrnoToStatus(errno, absl::StrCat("cannot rename ", temporary, " to ", target));
  }
  if (!status.ok()) ::unlink(temporary.c_str());
  return status;
}

}  // namespace curvecast
