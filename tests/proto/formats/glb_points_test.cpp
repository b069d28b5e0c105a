#include "proto/formats/glb_points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/proto/formats/parsed_glb.h"
#include "tests/proto/formats/sphere_columns.h"

namespace curvecast::formats {
namespace {

constexpr GlbOptions kFloats{.quantise = false}, kQuantised{}, kCompressed{.compress = true},
    kCompressedFloats{.quantise = false, .compress = true};

double light(std::uint8_t channel) {
  const double encoded = channel / 255.0;
  return encoded > 0.04045 ? std::pow((encoded + 0.055) / 1.055, 2.4) : encoded / 12.92;
}

TEST(GlbPoints, HoldWhatTheColumnsHoldInOrderOfRank) {
  const SpherePoints sphere(3000);
  PointColumns columns = sphere.columns();
  for (const std::array<double, 3>& origin : {std::array<double, 3>{}, std::array<double, 3>{500'000.25, -4'600'000.5, 12.125}}) {
    columns.origin = origin;
    for (const GlbOptions& options : {kFloats, kQuantised, kCompressed, kCompressedFloats}) {
      const auto bytes = make_glb(columns, options);
      ASSERT_TRUE(bytes.ok()) << bytes.status();
      const ParsedGlb glb(*bytes);
      EXPECT_EQ(glb.json["meshes"][0]["primitives"][0]["mode"], 0);
      const auto positions = glb.numbers("POSITION"), normals = glb.numbers("NORMAL"), colours = glb.numbers("COLOR_0"),
                 radii = glb.numbers("_RADIUS");
      ASSERT_EQ(positions.size(), 3000U);
      // Half a step of 65,535 along two units; floats are as they were.
      const double far = origin[0] != 0 ? 1e-9 : 0;
      const double most = options.quantise ? 1.01 / 65535 + far : far;
      for (std::size_t i = 0; i < positions.size(); ++i) {
        const std::size_t point = sphere.with_rank(i);
        const std::array<double, 3> place = glb.in_scene(positions[i]);
        double cosine = 0, length = 0;
        for (int axis = 0; axis < 3; ++axis) {
          ASSERT_NEAR(place[axis], columns.absolute(point, axis), most);
          ASSERT_NEAR(colours[i][axis], light(sphere.colours[point][axis]), 1e-5);
          cosine += normals[i][axis] * sphere.normals[point][axis];
          length += normals[i][axis] * normals[i][axis];
        }
        ASSERT_GT(cosine / std::sqrt(length), options.quantise ? std::cos(0.02) : 1 - 1e-6) << "1.1 degrees at most";
        ASSERT_EQ(colours[i][3], 1);
        ASSERT_NEAR(radii[i][0], sphere.radii[point], options.quantise && options.compress ? sphere.radii[point] * 3.1e-5 : 0);
      }
    }
  }
}

TEST(GlbPoints, SayTheirBoundsAsTheyAre) {
  const SpherePoints sphere(500);
  for (const GlbOptions& options : {kFloats, kQuantised, kCompressed}) {
    const ParsedGlb glb(*make_glb(sphere.columns(), options));
    const auto positions = glb.numbers("POSITION");
    const auto& accessor = glb.accessor("POSITION");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double low = positions[0][axis], high = low;
      for (const std::vector<double>& position : positions)
        low = std::min(low, position[axis]), high = std::max(high, position[axis]);
      EXPECT_EQ(accessor["min"][axis], low);
      EXPECT_EQ(accessor["max"][axis], high);
    }
  }
}

TEST(GlbPoints, NameTheExtensionsThatReadersNeed) {
  const SpherePoints sphere(50);
  const auto required = [&sphere](const GlbOptions& options) {
    const ParsedGlb glb(*make_glb(sphere.columns(), options));
    EXPECT_EQ(glb.json.value("extensionsUsed", nlohmann::json()), glb.json.value("extensionsRequired", nlohmann::json()));
    return glb.json.value("extensionsRequired", std::vector<std::string>());
  };
  EXPECT_EQ(required(kFloats), std::vector<std::string>());
  EXPECT_EQ(required(kQuantised), std::vector<std::string>{"KHR_mesh_quantization"});
  EXPECT_EQ(required(kCompressed), (std::vector<std::string>{"KHR_mesh_quantization", "EXT_meshopt_compression"}));
  EXPECT_EQ(required(kCompressedFloats), std::vector<std::string>{"EXT_meshopt_compression"});
}

// What comes over a slow line: the points whose bytes are there.
TEST(GlbPoints, BeginWithTheCoarsePoints) {
  const SpherePoints sphere(1000);
  for (const GlbOptions& options : {kFloats, kQuantised}) {
    const std::string bytes = *make_glb(sphere.columns(), options);
    const ParsedGlb whole(bytes);
    ASSERT_EQ(whole.json["bufferViews"].size(), 1U);
    const std::size_t stride = whole.json["bufferViews"][0]["byteStride"];
    const ParsedGlb part(bytes.substr(0, bytes.size() - 900 * stride), 100);
    auto first = whole.numbers("POSITION");
    first.resize(100);
    EXPECT_EQ(part.numbers("POSITION"), first);
  }
}

TEST(GlbPoints, AreSmallerQuantisedAndSmallerStillCompressed) {
  const SpherePoints sphere(5000);
  const std::size_t floats = make_glb(sphere.columns(), kFloats)->size(),
                    quantised = make_glb(sphere.columns(), kQuantised)->size(),
                    compressed = make_glb(sphere.columns(), kCompressed)->size();
  EXPECT_LT(quantised, 0.7 * static_cast<double>(floats));
  EXPECT_LT(compressed, 0.75 * static_cast<double>(quantised));
}

TEST(GlbPoints, MayHavePositionsAlone) {
  const std::vector<std::array<float, 3>> positions(4, {1.5F, -2.25F, 8.0F});
  PointColumns columns;
  columns.positions = positions;
  for (const GlbOptions& options : {kFloats, kQuantised, kCompressed, kCompressedFloats}) {
    const ParsedGlb glb(*make_glb(columns, options));
    EXPECT_EQ(glb.json["meshes"][0]["primitives"][0]["attributes"].size(), 1U);
    EXPECT_EQ(glb.in_scene(glb.numbers("POSITION")[3]), (std::array<double, 3>{1.5, -2.25, 8}));
  }
}

TEST(GlbPoints, RefuseBrokenColumnsAndNoPoints) {
  SpherePoints sphere(10);
  sphere.radii.pop_back();
  EXPECT_TRUE(absl::IsInvalidArgument(make_glb(sphere.columns(), {}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(make_glb({}, {}).status()));
}

TEST(GlbPoints, AreTheSameBytesAgain) {
  const SpherePoints sphere(300);
  for (const GlbOptions& options : {kFloats, kQuantised, kCompressed, kCompressedFloats}) {
    EXPECT_EQ(*make_glb(sphere.columns(), options), *make_glb(sphere.columns(), options));
  }
}

}  // namespace
}  // namespace curvecast::formats
