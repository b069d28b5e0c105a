#include "proto/formats/splat_ply.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/proto/formats/sphere_columns.h"

namespace curvecast::formats {
namespace {

constexpr std::size_t kFloats = 17;

std::string header_of(const std::string& bytes) { return bytes.substr(0, bytes.find("end_header\n") + 11); }

TEST(SplatPly, HoldsSplatsInOrderOfRank) {
  const SpherePoints sphere(600);
  const auto bytes = make_splat_ply(sphere.columns());
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const std::string header = header_of(*bytes);
  EXPECT_EQ(header,
            "ply\nformat binary_little_endian 1.0\nelement vertex 600\nproperty float x\nproperty float y\nproperty float z\n"
            "property float nx\nproperty float ny\nproperty float nz\nproperty float f_dc_0\nproperty float f_dc_1\n"
            "property float f_dc_2\nproperty float opacity\nproperty float scale_0\nproperty float scale_1\n"
            "property float scale_2\nproperty float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\n"
            "end_header\n");
  ASSERT_EQ(bytes->size(), header.size() + 600 * kFloats * sizeof(float));
  const Splats splats = *make_splats(sphere.columns());
  ByteReader reader(std::string_view(*bytes).substr(header.size()));
  for (std::size_t i = 0; i < 600; ++i) {
    const std::size_t point = sphere.with_rank(i);
    for (const float coordinate : sphere.positions[point]) ASSERT_EQ(reader.next<float>(), coordinate);
    for (const float coordinate : splats.normals[i]) ASSERT_EQ(reader.next<float>(), coordinate);
    for (const std::uint8_t channel : sphere.colours[point]) {
      ASSERT_NEAR(0.5 + 0.28209479177387814 * reader.next<float>(), channel / 255.0, 1e-6);
    }
    ASSERT_NEAR(1 / (1 + std::exp(-reader.next<float>())), 254.0 / 255, 1e-5);
    const float width = splats.widths[i];
    ASSERT_NEAR(std::exp(reader.next<float>()), width, 1e-6 * width);
    ASSERT_NEAR(std::exp(reader.next<float>()), width, 1e-6 * width);
    ASSERT_NEAR(std::exp(reader.next<float>()), 0.02 * width, 1e-6 * width);
    ASSERT_EQ(reader.next<float>(), splats.rotations[i][3]) << "w comes first";
    for (int k = 0; k < 3; ++k) ASSERT_EQ(reader.next<float>(), splats.rotations[i][k]);
  }
  EXPECT_TRUE(reader.at_end());
}

TEST(SplatPly, SaysWhereItsOriginIs) {
  const SpherePoints sphere(10);
  PointColumns columns = sphere.columns();
  columns.origin = {500'000.1, 4.6e6, 0};
  const std::string bytes = *make_splat_ply(columns);
  EXPECT_NE(header_of(bytes).find("comment origin 500000.09999999998 4600000 0\n"), std::string::npos) << header_of(bytes);
  ByteReader reader(std::string_view(bytes).substr(header_of(bytes).size()));
  for (const float coordinate : sphere.positions[sphere.with_rank(0)]) EXPECT_EQ(reader.next<float>(), coordinate);
}

TEST(SplatPly, RefusesWhatIsNoSplat) {
  const SpherePoints sphere(10);
  PointColumns columns = sphere.columns();
  columns.radii = {};
  EXPECT_TRUE(absl::IsInvalidArgument(make_splat_ply(columns).status()));
}

TEST(SplatPly, IsTheSameBytesAgain) {
  const SpherePoints sphere(300);
  EXPECT_EQ(*make_splat_ply(sphere.columns()), *make_splat_ply(sphere.columns()));
}

}  // namespace
}  // namespace curvecast::formats
