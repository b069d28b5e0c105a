#include "core/density/view_factor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/simd.h"
#include "core/density/picture_detail.h"

namespace curvecast {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kBatch = 256;  // of several cameras: what lies between them stays in the nearest cache

/// Takes one more factor into what they are at most. Where its change has no bound, a factor is itself the most.
CURVECAST_WIDE void take_most(const float* __restrict factor, const float* __restrict change, std::size_t n,
                              float* __restrict most) {
  for (std::size_t i = 0; i < n; ++i) most[i] *= change[i] < kInfinity ? factor[i] * (1 + change[i]) : factor[i];
}

/// Takes one more factor into an upper bound on n blocks.
template <typename Factor>
void multiply_most(const Factor& factor, const BlockColumns& blocks, std::size_t n, float* most) {
  float value[kBatch], change[kBatch];
  std::fill_n(value, n, 1.0f);
  std::fill_n(change, n, 0.0f);
  factor.multiply_blocks(blocks, n, value, change);
  take_most(value, change, n, most);
}
void multiply_most(const PictureFactor& factor, const BlockColumns& blocks, std::size_t n, float* most) {
  factor.multiply_most(blocks, n, most);
}

/// Takes one more camera into what is most, at most and at least among them.
CURVECAST_WIDE void take_larger(const float* __restrict factor, const float* __restrict change, std::size_t n,
                                float* __restrict middle, float* __restrict high, float* __restrict low) {
  for (std::size_t i = 0; i < n; ++i) {
    const float above = factor[i] > 0 ? factor[i] * (1 + change[i]) : 0.0f;
    const float below = factor[i] > 0 && change[i] < 1 ? factor[i] * (1 - change[i]) : 0.0f;
    middle[i] = factor[i] > middle[i] ? factor[i] : middle[i];
    high[i] = above > high[i] ? above : high[i];
    low[i] = below > low[i] ? below : low[i];
  }
}

/// A camera whose picture shows a little more on all sides.
Camera with_margin(Camera camera) {
  camera.height *= kPictureMargin;
  camera.fov = 2 * std::atan(kPictureMargin * std::tan(0.5 * camera.fov));
  return camera;
}

}  // namespace

ViewFactor::ViewFactor(const SurfaceCurve& curve, const Density& density) {
  if (std::none_of(density.terms.begin(), density.terms.end(), is_camera_term)) return;
  std::vector<CameraFrame> frames;
  for (const Camera& camera : density.cameras) frames.emplace_back(camera, curve.origin, curve.box);
  const ScreenWeights weights = screen_weights(density.cameras, frames);
  pixels_ = weights.pixels;
  const auto is_picture = [](const DensityTerm& term) { return std::holds_alternative<PictureTerm>(term); };
  is_fixed_by_detail_ =
      std::ranges::count_if(density.terms, is_fixed_term) == 1 && std::ranges::any_of(density.terms, is_picture);
  for (std::size_t c = 0; c < frames.size(); ++c) {
    std::vector<Factor>& factors = cameras_.emplace_back();
    for (const DensityTerm& term : density.terms) {
      if (const auto* view = std::get_if<ViewTerm>(&term)) factors.emplace_back(SilhouetteFactor(frames[c], *view));
      if (const auto* distance = std::get_if<DistanceTerm>(&term)) factors.emplace_back(DistanceFactor(frames[c], *distance));
      if (std::holds_alternative<FrustumTerm>(term)) factors.emplace_back(FrustumFactor(frames[c]));
      if (std::holds_alternative<ScreenTerm>(term)) factors.emplace_back(ScreenFactor(frames[c], weights.of_camera[c]));
      if (std::holds_alternative<PictureTerm>(term)) {
        beside_ = curve.beside;
        const CameraFrame wider(with_margin(density.cameras[c]), curve.origin, curve.box);
        factors.emplace_back(PictureFactor(frames[c], wider, weights.of_camera[c]));
      }
    }
  }
}

void ViewFactor::multiply(const VertexColumns& vertices, std::size_t n, float* factor) const {
  const auto multiply_all = [](const std::vector<Factor>& factors, const VertexColumns& some, std::size_t count, float* out) {
    for (const Factor& one : factors) std::visit([&](const auto& f) { f.multiply(some, count, out); }, one);
  };
  if (is_one()) return;
  if (cameras_.size() == 1) return multiply_all(cameras_[0], vertices, n, factor);
  float largest[kBatch], of_camera[kBatch];
  for (std::size_t begin = 0; begin < n; begin += kBatch) {
    const std::size_t count = std::min(kBatch, n - begin);
    const VertexColumns some = vertices.from(begin);
    std::fill_n(largest, count, 0.0f);
    for (const std::vector<Factor>& factors : cameras_) {
      std::fill_n(of_camera, count, 1.0f);
      multiply_all(factors, some, count, of_camera);
      for (std::size_t i = 0; i < count; ++i) largest[i] = of_camera[i] > largest[i] ? of_camera[i] : largest[i];
    }
    for (std::size_t i = 0; i < count; ++i) factor[begin + i] *= largest[i];
  }
}

void ViewFactor::of_blocks(const CurveBlocks& blocks, std::size_t begin, std::size_t end, float* __restrict factor,
                           float* __restrict change) const {
  const BlockColumns columns = BlockColumns::of(blocks);
  const auto of_camera = [&](const std::vector<Factor>& factors, std::size_t first, std::size_t count, float* value,
                             float* most) {
    std::fill_n(value, count, 1.0f);
    std::fill_n(most, count, 0.0f);
    for (const Factor& one : factors) {
      std::visit([&](const auto& f) { f.multiply_blocks(columns.from(first), count, value, most); }, one);
    }
  };
  if (cameras_.size() == 1) return of_camera(cameras_[0], begin, end - begin, factor, change);
  if (is_one()) {
    std::fill_n(factor, end - begin, 1.0f);
    std::fill_n(change, end - begin, 0.0f);
    return;
  }
  float value[kBatch], most[kBatch], high[kBatch], low[kBatch];
  for (std::size_t first = begin; first < end; first += kBatch, factor += kBatch, change += kBatch) {
    const std::size_t count = std::min(kBatch, end - first);
    for (float* const all : {factor, high, low}) std::fill_n(all, count, 0.0f);
    for (const std::vector<Factor>& factors : cameras_) {
      of_camera(factors, first, count, value, most);
      take_larger(value, most, count, factor, high, low);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const float rise = high[i] - factor[i], fall = factor[i] - low[i];
      change[i] = factor[i] > 0 ? (rise > fall ? rise : fall) / factor[i] : 0.0f;
    }
  }
}

void ViewFactor::most_of_blocks(const BlockColumns& blocks, std::size_t n, float* most) const {
  if (is_one()) {
    std::fill_n(most, n, 1.0f);
    return;
  }
  float of_camera[kBatch];
  for (std::size_t first = 0; first < n; first += kBatch, most += kBatch) {
    const std::size_t count = std::min(kBatch, n - first);
    std::fill_n(most, count, 0.0f);
    for (const std::vector<Factor>& factors : cameras_) {
      std::fill_n(of_camera, count, 1.0f);
      for (const Factor& one : factors) {
        std::visit([&](const auto& f) { multiply_most(f, blocks.from(first), count, of_camera); }, one);
      }
      for (std::size_t i = 0; i < count; ++i) most[i] = std::max(most[i], of_camera[i]);
    }
  }
}

}  // namespace curvecast
