// Pictures as files, for tests.
#pragma once

#include <png.h>
#include <turbojpeg.h>
#include <webp/encode.h>

#include <string>

#include "core/base/image.h"

namespace curvecast {

/// A picture of one colour.
inline Image plain_image(int width, int height, std::uint8_t r, std::uint8_t g, std::uint8_t b, std::uint8_t a = 255) {
  const std::uint8_t pixel[] = {r, g, b, a};
  Image image{.width = width, .height = height, .rgba = {}};
  image.rgba.resize(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (std::size_t i = 0; i < image.rgba.size(); ++i) image.rgba[i] = pixel[i % 4];
  return image;
}

inline std::string png_file(const Image& image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGBA;
  png_alloc_size_t size = 0;
  png_image_write_to_memory(&png, nullptr, &size, 0, image.rgba.data(), 0, nullptr);
  std::string bytes(size, '\0');
  png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgba.data(), 0, nullptr);
  bytes.resize(size);
  return bytes;
}

inline std::string jpeg_file(const Image& image) {
  tjhandle encoder = tjInitCompress();
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  tjCompress2(encoder, image.rgba.data(), image.width, 0, image.height, TJPF_RGBA, &bytes, &size, TJSAMP_444, 95, 0);
  std::string file(reinterpret_cast<char*>(bytes), size);
  tjFree(bytes);
  tjDestroy(encoder);
  return file;
}

/// Without loss, or with some.
inline std::string webp_file(const Image& image, bool lossless = true) {
  std::uint8_t* bytes = nullptr;
  const std::size_t size = lossless
                               ? WebPEncodeLosslessRGBA(image.rgba.data(), image.width, image.height, 4 * image.width, &bytes)
                               : WebPEncodeRGBA(image.rgba.data(), image.width, image.height, 4 * image.width, 95, &bytes);
  std::string file(reinterpret_cast<char*>(bytes), size);
  WebPFree(bytes);
  return file;
}

}  // namespace curvecast
