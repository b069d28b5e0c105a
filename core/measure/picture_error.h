// How far a picture is from another one, by measures that everybody knows.
// Source: Wang, Bovik, Sheikh, Simoncelli, "Image quality assessment: from error visibility to structural similarity", IEEE
// Transactions on Image Processing 13(4), 2004.
#pragma once

#include "core/base/image.h"

namespace curvecast {

/// Returns the peak signal-to-noise ratio over red, green and blue, dB; infinite where nothing differs. Alpha does not count.
/// Precondition: as wide and as high, with at least one pixel.
double psnr(const Image& reference, const Image& test);

/// Returns the mean structural similarity of the lightness (0.299 red + 0.587 green + 0.114 blue), under a Gaussian window of
/// 11 x 11 pixels and a deviation of 1.5, where that lies within the picture: at most 1. Precondition: as wide and as high, at
/// least 11 pixels each way.
double ssim(const Image& reference, const Image& test);

}  // namespace curvecast
