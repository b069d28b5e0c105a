#include "core/density/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace curvecast {
namespace {

using ::testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Camera, RefusesWhatSeesNothingByName) {
  const std::vector<std::pair<std::string, std::function<void(Camera&)>>> cases = {
      {"eye is not finite", [](Camera& c) { c.eye.x() = kNaN; }},
      {"target is not finite", [](Camera& c) { c.target.z() = -kInfinity; }},
      {"up is not finite", [](Camera& c) { c.up.y() = kInfinity; }},
      {"same point", [](Camera& c) { c.target = c.eye; }},
      {"up has no length", [](Camera& c) { c.up.setZero(); }},
      {"up is along the view", [](Camera& c) { c.up = Vec3d(0, 0, 1e-200); }},
      {"fov = 0", [](Camera& c) { c.fov = 0; }},
      {"fov = 3.2", [](Camera& c) { c.fov = 3.2; }},
      {"fov = nan", [](Camera& c) { c.fov = kNaN; }},
      {"height = -1", [](Camera& c) { c.height = -1; }},
      {"height = inf", [](Camera& c) { c.height = kInfinity; }},
      {"aspect = 0", [](Camera& c) { c.aspect = 0; }},
      {"aspect = nan", [](Camera& c) { c.aspect = kNaN; }},
      {"pixels = -5", [](Camera& c) { c.pixels = -5; }},
  };
  EXPECT_TRUE(check_camera({}).ok());
  for (const auto& [expected, spoil] : cases) {
    Camera camera;
    spoil(camera);
    const absl::Status status = check_camera(camera);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << expected;
    EXPECT_THAT(std::string(status.message()), HasSubstr(expected));
  }
}

TEST(Camera, HasAxesAsFarAsDoublesGo) {
  for (const double far : {1e-300, 1.0, 1.5e308}) {
    const Camera camera{.eye = far * Vec3d(1, 0, 0), .target = -far * Vec3d(1, 0, 0), .up = Vec3d(0.5, 0, 3)};
    ASSERT_TRUE(check_camera(camera).ok());
    const CameraAxes axes = axes_of(camera);
    EXPECT_LT((axes.forward - Vec3d(-1, 0, 0)).norm(), 1e-12);
    EXPECT_LT((axes.up - Vec3d(0, 0, 1)).norm(), 1e-12);
    EXPECT_LT((axes.right - axes.forward.cross(axes.up)).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace curvecast
