#include "core/mesh_io/reading/texture_image.h"
#include "tests/fuzz/fuzz_expect.h"
#include "tests/fuzz/fuzz_input.h"

void curvecast::fuzzing::take_input(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint64_t kMostPixels = 1 << 20;
  const absl::StatusOr<Image> image = decode_texture({reinterpret_cast<const char*>(data), size}, kMostPixels);
  if (!image.ok()) return;
  const std::size_t pixels = static_cast<std::size_t>(image->width) * static_cast<std::size_t>(image->height);
  expect(image->width > 0 && image->height > 0 && pixels <= kMostPixels, "a size that was not asked for");
  expect(image->rgba.size() == 4 * pixels, "the size is not that of the pixels");
}
