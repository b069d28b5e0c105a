#include "client/bench/scene/stop_picture.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <vector>

#include "client/bench/scene/mesh_picture.h"
#include "client/bench/scene/point_picture.h"
#include "client/lib/file_bytes.h"
#include "core/render/png_file.h"

namespace curvecast::cli::bench {
namespace {

constexpr Rgb8 kBackground = {255, 0, 255};  // no surface looks like it

/// Of one sample for each pixel, so that a pixel is either covered or not.
absl::StatusOr<Image> draw_samples(const client::Points& points, const v1::Camera& camera, int width, int height) {
  RenderOptions options{.width = width, .height = height, .supersample = 1, .ambient_occlusion = false};
  options.background_top = options.background_bottom = kBackground;
  return draw_points(points, camera, options, false);
}

bool is_background(const Image& image, std::size_t pixel) {
  return std::equal(kBackground.begin(), kBackground.end(), image.rgba.begin() + static_cast<std::ptrdiff_t>(4 * pixel));
}

Image side_by_side(const Image& left, const Image& right) {
  Image both{left.width + right.width, left.height, {}};
  const auto append = [&](const Image& image, int row) {
    const auto begin = image.rgba.begin() + std::ptrdiff_t{4} * row * image.width;
    both.rgba.insert(both.rgba.end(), begin, begin + std::ptrdiff_t{4} * image.width);
  };
  for (int row = 0; row < left.height; ++row) append(left, row), append(right, row);
  return both;
}

}  // namespace

absl::StatusOr<double> draw_stop(const client::Points& points, const TriangleMesh& mesh, const v1::Camera& camera,
                                 const v1::Viewport& viewport, const std::string& path) {
  const int width = static_cast<int>(viewport.width()), height = static_cast<int>(viewport.height());
  const MeshPicture wanted = draw_mesh(mesh, camera_from(camera, Vec3d::Zero()), width, height);
  Image shown = wanted.image;
  std::size_t covered = 0, outline = 0;
  if (points.size() > 0) {
    absl::StatusOr<Image> drawn = draw_samples(points, camera, width, height);
    if (!drawn.ok()) return drawn.status();
    shown = *std::move(drawn);
  }
  for (std::size_t i = 0; i < wanted.covered.size(); ++i) {
    const bool is_shown = points.size() > 0 && !is_background(shown, i);
    outline += wanted.covered[i];
    covered += is_shown ? wanted.covered[i] : 0;
    // Holes stay as they are drawn, to be seen; elsewhere the background is the other picture's.
    if (!is_shown && wanted.covered[i] == 0) std::memcpy(&shown.rgba[4 * i], &wanted.image.rgba[4 * i], 4);
    if (!is_shown && wanted.covered[i] != 0) std::copy(kBackground.begin(), kBackground.end(), &shown.rgba[4 * i]);
  }
  const absl::StatusOr<std::string> png = encode_png(side_by_side(shown, wanted.image));
  if (!png.ok()) return png.status();
  if (absl::Status status = client::write_bytes(path, *png); !status.ok()) return status;
  return outline > 0 ? static_cast<double>(covered) / static_cast<double>(outline) : 1;
}

}  // namespace curvecast::cli::bench
