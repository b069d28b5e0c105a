#include "core/density/picture_factor.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/density/picture_detail.h"
#include "tests/core/density/sphere_curve.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using testing::camera_at;
using testing::sphere_curve;

/// A picture's factor, and those that it is the product of.
struct Factors {
  Factors(const SurfaceCurve& curve, const Camera& camera)
      : frame(camera, curve.origin, curve.box), picture(frame, frame, 0.7f), screen(frame, 0.7f), frustum(frame) {}

  CameraFrame frame;
  PictureFactor picture;
  ScreenFactor screen;
  FrustumFactor frustum;
};

std::vector<Camera> some_cameras() {
  std::vector<Camera> cameras = {camera_at({0, 0, 1.2}), camera_at({2, 1, 0}), camera_at({0.3, 0.2, 0.1}), camera_at({90, 7, 0})};
  cameras.push_back(cameras[1]);
  cameras.back().height = 0.7;
  return cameras;
}

TEST(PictureFactor, IsTheProductOfScreenOutlinesAndFrustum) {
  const SurfaceCurve curve = sphere_curve(3000);
  for (const Camera& camera : some_cameras()) {
    const Factors factors(curve, camera);
    std::vector<float> picture(curve.size(), 2.0f), product(curve.size(), 2.0f);
    factors.picture.multiply(VertexColumns::of(curve), curve.size(), picture.data());
    factors.screen.multiply(VertexColumns::of(curve), curve.size(), product.data());
    SilhouetteFactor(factors.frame, {.s0 = kPictureFloor}).multiply(VertexColumns::of(curve), curve.size(), product.data());
    factors.frustum.multiply(VertexColumns::of(curve), curve.size(), product.data());
    for (std::size_t l = 0; l < curve.size(); ++l) ASSERT_NEAR(picture[l], product[l], 1e-6 * product[l]) << l;
  }
}

TEST(PictureFactor, TakesTheNormalBesideWhereItsOwnFacesAway) {
  SurfaceCurve curve = sphere_curve(3000), turned = curve;
  curve.beside.resize(curve.size());
  for (std::size_t l = 0; l < curve.size(); ++l) {
    curve.beside[l] = l % 3 == 0 ? Direction8(Vec3f(-curve.normal(l))) : Direction8{};
    const Vec3f other = curve.beside[l].unpacked<Vec3f>();
    turned.nx[l] = other.x(), turned.ny[l] = other.y(), turned.nz[l] = other.z();
  }
  for (const Camera& camera : some_cameras()) {
    const Factors factors(curve, camera);
    std::vector<float> both(curve.size(), 1.0f), own = both, beside = both;
    factors.picture.multiply(VertexColumns::of(curve), curve.size(), both.data());
    VertexColumns without = VertexColumns::of(curve);
    without.beside = nullptr;
    factors.picture.multiply(without, curve.size(), own.data());
    factors.picture.multiply(VertexColumns::of(turned), curve.size(), beside.data());
    for (std::size_t l = 0; l < curve.size(); ++l) {
      const float expected = own[l] > 0 ? own[l] : beside[l];
      ASSERT_NEAR(both[l], expected, 1e-3 * expected) << l;
    }
  }
}

TEST(PictureFactor, BoundsBlocksMoreCloselyThanItsPartsDo) {
  SurfaceCurve curve = sphere_curve(3000);
  curve.blocks = build_blocks(curve);
  const BlockColumns blocks = BlockColumns::of(curve.blocks);
  const std::size_t n = curve.blocks.size();
  for (const Camera& camera : some_cameras()) {
    const Factors factors(curve, camera);
    std::vector<float> of_vertex(curve.size(), 1.0f), most(n, 1.0f), value(n, 1.0f), change(n, 0.0f);
    factors.picture.multiply(VertexColumns::of(curve), curve.size(), of_vertex.data());
    factors.picture.multiply_most(blocks, n, most.data());
    factors.picture.multiply_blocks(blocks, n, value.data(), change.data());
    for (std::size_t l = 0; l < curve.size(); ++l) ASSERT_LE(of_vertex[l], 1.0001f * most[l / kBlockSize]) << l;
    for (std::size_t b = 0; b < n; ++b) {
      if (change[b] < 1e9f) {
        ASSERT_LE(most[b], 1.0001f * value[b] * (1 + change[b])) << b;
      }
      ASSERT_EQ(most[b] == 0, value[b] == 0) << b;
    }
  }
}

}  // namespace
}  // namespace curvecast
