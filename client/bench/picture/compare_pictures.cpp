#include "client/bench/picture/compare_pictures.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/measure/flip.h"
#include "core/measure/picture_error.h"

namespace curvecast::cli::bench {
namespace {

constexpr int kReferenceSamples = 4, kSamples = 2;  // of a pixel along each axis
constexpr int kOutlineReach = 2;                    // pixels
constexpr Rgb8 kNothing = {255, 0, 255};            // no surface looks like it

/// Which pixels something covers, in their middles.
absl::StatusOr<std::vector<std::uint8_t>> covered_by(DrawPicture draw, RenderOptions options) {
  options.supersample = 1;
  options.ambient_occlusion = false;
  options.background_top = options.background_bottom = kNothing;
  const absl::StatusOr<Image> image = draw(options);
  if (!image.ok()) return image.status();
  std::vector<std::uint8_t> covered;
  for (std::size_t i = 0; i < image->rgba.size(); i += 4) {
    covered.push_back(!std::equal(kNothing.begin(), kNothing.end(), image->rgba.begin() + static_cast<std::ptrdiff_t>(i)));
  }
  return covered;
}

/// Whether all pixels within the reach of one, in rows and columns, are as it is.
bool is_inside(const std::vector<std::uint8_t>& covered, int width, int height, int x, int y) {
  const auto at = [&](int column, int row) { return covered[static_cast<std::size_t>(row * width + column)]; };
  for (int row = std::max(0, y - kOutlineReach); row <= std::min(height - 1, y + kOutlineReach); ++row) {
    for (int column = std::max(0, x - kOutlineReach); column <= std::min(width - 1, x + kOutlineReach); ++column) {
      if (at(column, row) != at(x, y)) return false;
    }
  }
  return true;
}

}  // namespace

absl::StatusOr<PictureReference> PictureReference::draw(DrawPicture draw, const RenderOptions& size) {
  PictureReference reference;
  reference.size_ = size;
  RenderOptions options = size;
  options.supersample = kReferenceSamples;
  absl::StatusOr<Image> image = draw(options);
  if (!image.ok()) return image.status();
  reference.image_ = *std::move(image);
  absl::StatusOr<std::vector<std::uint8_t>> covered = covered_by(draw, size);
  if (!covered.ok()) return covered.status();
  reference.covered_ = *std::move(covered);
  return reference;
}

absl::StatusOr<PictureScore> PictureReference::score(DrawPicture draw, Image& image) const {
  RenderOptions options = size_;
  options.supersample = kSamples;
  absl::StatusOr<Image> drawn = draw(options);
  if (!drawn.ok()) return drawn.status();
  image = *std::move(drawn);
  PictureScore score{flip_error(image_, image).mean, psnr(image_, image), ssim(image_, image)};
  const absl::StatusOr<std::vector<std::uint8_t>> covered = covered_by(draw, size_);
  if (!covered.ok()) return covered.status();
  for (int y = 0; y < image_.height; ++y) {
    for (int x = 0; x < image_.width; ++x) {
      const auto i = static_cast<std::size_t>(y * image_.width + x);
      if ((*covered)[i] == covered_[i]) continue;
      if (!is_inside(covered_, image_.width, image_.height, x, y)) {
        ++score.outline;
      } else if (covered_[i] != 0) {
        ++score.holes;
      }
    }
  }
  return score;
}

}  // namespace curvecast::cli::bench
