#include "proto/formats/glb_splats.h"

#include <gtest/gtest.h>

#include "tests/proto/formats/parsed_glb.h"
#include "tests/proto/formats/sphere_columns.h"

namespace curvecast::formats {
namespace {

std::vector<double> as_doubles(const auto& floats) { return {floats.begin(), floats.end()}; }

TEST(GlbSplats, HoldTheSplatsInOrderOfRank) {
  const SpherePoints sphere(800);
  PointColumns columns = sphere.columns();
  columns.origin = {1e6, 0, -3};
  const auto bytes = make_glb_splats(columns);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const ParsedGlb glb(*bytes);
  EXPECT_EQ(glb.json["extensionsUsed"], nlohmann::json::array({"KHR_gaussian_splatting"}));
  EXPECT_FALSE(glb.json.contains("extensionsRequired")) << "others draw points";
  const nlohmann::json& primitive = glb.json["meshes"][0]["primitives"][0];
  EXPECT_EQ(primitive["mode"], 0);
  EXPECT_EQ(primitive["extensions"]["KHR_gaussian_splatting"],
            (nlohmann::json{{"kernel", "ellipse"}, {"colorSpace", "srgb_rec709_display"}}));
  const Splats splats = *make_splats(columns);
  const auto positions = glb.numbers("POSITION"), rotations = glb.numbers("KHR_gaussian_splatting:ROTATION"),
             scales = glb.numbers("KHR_gaussian_splatting:SCALE"), opacities = glb.numbers("KHR_gaussian_splatting:OPACITY"),
             harmonics = glb.numbers("KHR_gaussian_splatting:SH_DEGREE_0_COEF_0"), colours = glb.numbers("COLOR_0");
  ASSERT_EQ(positions.size(), 800U);
  for (std::size_t i = 0; i < 800; ++i) {
    const std::array<double, 3> place = glb.in_scene(positions[i]);
    for (int axis = 0; axis < 3; ++axis) ASSERT_EQ(place[axis], columns.absolute(sphere.with_rank(i), axis));
    ASSERT_EQ(rotations[i], as_doubles(splats.rotations[i]));
    const double width = splats.widths[i];
    ASSERT_EQ(scales[i], (std::vector<double>{width, width, splats.widths[i] * kSplatThickness}));
    ASSERT_EQ(opacities[i][0], kSplatOpacity);
    for (int channel = 0; channel < 3; ++channel) {
      ASSERT_NEAR(0.5 + 0.28209479177387814 * harmonics[i][channel], sphere.colours[sphere.with_rank(i)][channel] / 255.0, 1e-6);
    }
    ASSERT_NEAR(colours[i][3], kSplatOpacity, 1e-5);
  }
}

TEST(GlbSplats, RefuseWhatIsNoSplatAndNoPoints) {
  const SpherePoints sphere(10);
  PointColumns columns = sphere.columns();
  columns.normals = {};
  EXPECT_TRUE(absl::IsInvalidArgument(make_glb_splats(columns).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(make_glb_splats({}).status()));
}

TEST(GlbSplats, AreTheSameBytesAgain) {
  const SpherePoints sphere(300);
  EXPECT_EQ(*make_glb_splats(sphere.columns()), *make_glb_splats(sphere.columns()));
}

}  // namespace
}  // namespace curvecast::formats
