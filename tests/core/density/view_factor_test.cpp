#include "core/density/view_factor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "core/pipeline/pipeline.h"
#include "tests/core/density/sphere_curve.h"
#include "tests/support/shapes.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using testing::camera_at;
using testing::seen_from;

std::shared_ptr<const SurfaceCurve> curve_of(const PolygonSoup& soup, std::uint64_t points) {
  const std::string off = testing::to_off(soup);
  absl::StatusOr<Preprocessed> made = preprocess({"shape.off", off}, {.points = points});
  EXPECT_TRUE(made.ok()) << made.status();
  return made->curve;
}

/// Perspective and orthographic, near and far, from inside and outside.
std::vector<Camera> some_cameras() {
  std::vector<Camera> cameras;
  for (const Vec3d& eye : {Vec3d(0, 0, 5), Vec3d(1.5, 0.3, 0.2), Vec3d(100, -300, 50), Vec3d(0.9, 0.9, 0.9), Vec3d(0, 0, 1e9),
                           Vec3d(0.1, 0.1, 0.05), Vec3d(1.01, 0, 0)}) {
    for (const double fov : {0.2, 1.0}) {
      Camera camera = camera_at(eye, Vec3d(0.3, 0.2, 0.1));
      camera.fov = fov;
      camera.aspect = 1.5;
      cameras.push_back(camera);
    }
    cameras.back().height = 1.2;
  }
  return cameras;
}

const std::vector<std::vector<DensityTerm>> kTermSets = {
    {ViewTerm{}},
    {ViewTerm{.s0 = kMaxS0}},
    {DistanceTerm{}},
    {DistanceTerm{.near = 0.5, .far = 3}},
    {FrustumTerm{}},
    {ScreenTerm{}},
    {ScreenTerm{}, FrustumTerm{}},
    {PictureTerm{}},
    {ViewTerm{}, DistanceTerm{}, FrustumTerm{}, ScreenTerm{}},
};

/// The change of every block is as large as the largest on its vertices at least. Returns the share of blocks with a finite one.
double expect_bounds(const SurfaceCurve& curve, const Density& density) {
  const ViewFactor view(curve, density);
  const std::size_t blocks = curve.blocks.size();
  std::vector<float> factor(blocks), change(blocks), of_vertex(curve.size(), 1.0f);
  view.of_blocks(curve.blocks, 0, blocks, factor.data(), change.data());
  std::vector<float> highest(blocks);
  view.most_of_blocks(BlockColumns::of(curve.blocks), blocks, highest.data());
  view.multiply(VertexColumns::of(curve), curve.size(), of_vertex.data());
  double known = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    EXPECT_TRUE(std::isfinite(factor[b]) && factor[b] >= 0) << "block " << b;
    EXPECT_FALSE(std::isnan(change[b])) << "block " << b;
    for (std::size_t l = b * kBlockSize; l < std::min((b + 1) * kBlockSize, curve.size()); ++l) {
      EXPECT_LE(of_vertex[l], 1.0001f * highest[b]) << "block " << b << ", vertex " << l;
      if (factor[b] == 0) {
        EXPECT_EQ(of_vertex[l], 0) << "block " << b << ", vertex " << l;
      } else if (std::isfinite(change[b])) {
        const double most = static_cast<double>(change[b]) * static_cast<double>(factor[b]);
        EXPECT_LE(std::abs(of_vertex[l] - factor[b]), most) << "block " << b << ", vertex " << l;
      }
    }
    known += factor[b] == 0 || change[b] < 1 ? 1 : 0;
    if (::testing::Test::HasFailure()) break;
  }
  return known / static_cast<double>(blocks);
}

TEST(ViewFactor, BoundsWhatChangesWithinABlock) {
  for (const PolygonSoup& soup : {testing::icosphere(5), testing::torus(60, 30), testing::perforated_slab(5, 3)}) {
    const auto curve = curve_of(soup, 10'000);
    for (const std::vector<DensityTerm>& terms : kTermSets) {
      for (const Camera& camera : some_cameras()) {
        expect_bounds(*curve, Density(terms, {camera}));
        ASSERT_FALSE(HasFailure()) << "term " << terms[0].index() << ", eye " << camera.eye.transpose();
      }
      std::vector<Camera> cameras = some_cameras();
      expect_bounds(*curve, Density(terms, cameras));
      cameras.resize(2);
      expect_bounds(*curve, Density(terms, cameras));
      ASSERT_FALSE(HasFailure()) << "term " << terms[0].index();
    }
  }
}

TEST(ViewFactor, KnowsMostBlocksWell) {
  const auto curve = curve_of(testing::icosphere(5), 40'000);
  for (const std::vector<DensityTerm>& terms : kTermSets) {
    EXPECT_GT(expect_bounds(*curve, seen_from(Vec3d(0, 0.5, 4), terms)), 0.85) << "term " << terms[0].index();
  }
}

TEST(ViewFactor, BoundsAreRightAtEverySizeAndFarOut) {
  for (const double radius : {1e-12, 1e-3, 2e14}) {
    const Vec3d origin = 50 * radius * Vec3d(1, -2, 3);
    SurfaceCurve curve = testing::sphere_curve(4000, radius, origin);
    curve.blocks = build_blocks(curve);
    for (const std::vector<DensityTerm>& terms : kTermSets) {
      for (Camera camera : some_cameras()) {
        camera.eye = origin + radius * camera.eye;
        camera.target = origin + radius * camera.target;
        camera.height *= radius;
        expect_bounds(curve, Density(terms, {camera}));
        ASSERT_FALSE(HasFailure()) << "term " << terms[0].index() << ", eye " << camera.eye.transpose();
      }
    }
  }
}

TEST(ViewFactor, OfSeveralCamerasIsTheLargest) {
  const SurfaceCurve curve = testing::sphere_curve(3000);
  const std::vector<Camera> cameras = some_cameras();
  for (const std::vector<DensityTerm>& terms : {std::vector<DensityTerm>{ViewTerm{}, FrustumTerm{}}, {DistanceTerm{}}}) {
    std::vector<float> all(curve.size()), one(curve.size()), largest(curve.size(), 0.0f);
    ASSERT_TRUE(evaluate_density(curve, Density(terms, cameras), all).ok());
    for (const Camera& camera : cameras) {
      ASSERT_TRUE(evaluate_density(curve, Density(terms, {camera}), one).ok());
      for (std::size_t l = 0; l < one.size(); ++l) largest[l] = std::max(largest[l], one[l]);
    }
    EXPECT_EQ(all, largest);
  }
}

TEST(ViewFactor, OfAnOrthographicViewIsThatFromVeryFar) {
  const SurfaceCurve curve = testing::sphere_curve(3000);
  Density flat = seen_from(Vec3d(3, 4, 5)), far = seen_from(1e9 * Vec3d(3, 4, 5));
  flat.cameras[0].height = 1;
  std::vector<float> a(curve.size()), b(curve.size());
  ASSERT_TRUE(evaluate_density(curve, flat, a).ok());
  ASSERT_TRUE(evaluate_density(curve, far, b).ok());
  for (std::size_t l = 0; l < a.size(); ++l) {
    if (std::abs(curve.position(l).dot(Vec3f(3, 4, 5).normalized())) > 1e-4f) {
      ASSERT_NEAR(a[l], b[l], 1e-5) << l;
    }
  }
}

TEST(ViewFactor, WithoutCameraTermsIsOne) {
  const SurfaceCurve curve = testing::sphere_curve(100);
  EXPECT_TRUE(ViewFactor(curve, {}).is_one());
  EXPECT_TRUE(ViewFactor(curve, Density({CurvatureTerm{}}, {camera_at(Vec3d(0, 0, 3))})).is_one());
  EXPECT_FALSE(ViewFactor(curve, seen_from(Vec3d(0, 0, 3))).is_one());
}

}  // namespace
}  // namespace curvecast
