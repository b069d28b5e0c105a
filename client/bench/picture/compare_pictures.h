// How good a picture is that stands for a mesh.
#pragma once

#include <absl/functional/function_ref.h>
#include <absl/status/statusor.h>

#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/render/splat_renderer.h"

namespace curvecast::cli::bench {

/// Draws something, from a place of its own.
using DrawPicture = absl::FunctionRef<absl::StatusOr<Image>(const RenderOptions& options)>;

struct PictureScore {
  double flip = 0, psnr = 0, ssim = 0;  // see flip.h and picture_error.h
  std::uint64_t outline = 0;            // pixels within two of the mesh's outline that are covered, or not, against the mesh
  std::uint64_t holes = 0;              // pixels farther within it that are not covered
};

/// What pictures are held against: drawn once, of more samples than others.
class PictureReference {
 public:
  /// Errors are those of `draw`. `size`: width and height count.
  static absl::StatusOr<PictureReference> draw(DrawPicture draw, const RenderOptions& size);

  const Image& image() const { return image_; }
  /// Draws a picture of the same size, which is left in `image`, and compares. Errors as of `draw`.
  absl::StatusOr<PictureScore> score(DrawPicture draw, Image& image) const;

 private:
  RenderOptions size_;
  Image image_;
  std::vector<std::uint8_t> covered_;  // each pixel: 1 where the mesh is seen in its middle
};

}  // namespace curvecast::cli::bench
