#include "server/web/resources/point_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string>

namespace curvecast::server {
namespace {

using ::testing::StartsWith;

/// A block of points along a line, as the API sends them.
v1::PointBlock block_of(int first, int count) {
  v1::PointBlock block;
  block.set_count(static_cast<std::uint32_t>(count));
  block.mutable_origin()->set_x(10);
  v1::RawPoints& raw = *block.mutable_raw();
  const auto put = [](std::string& column, float value) { column.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (int i = first; i < first + count; ++i) {
    for (const float value : {static_cast<float>(i), 0.0F, 0.0F}) put(*raw.mutable_positions(), value);
    for (const float value : {0.0F, 0.0F, 1.0F}) put(*raw.mutable_normals(), value);
    put(*raw.mutable_radii(), 0.5F);
  }
  return block;
}

TEST(PointFile, BlocksAreJoined) {
  GatheredPoints points;
  ASSERT_TRUE(points.append(block_of(0, 3)).ok());
  ASSERT_TRUE(points.append(block_of(3, 2)).ok());
  const formats::PointColumns columns = points.columns();
  ASSERT_EQ(columns.size(), 5u);
  EXPECT_EQ(columns.absolute(4, 0), 14);
  EXPECT_EQ(columns.radii.size(), 5u);
  EXPECT_TRUE(columns.colours.empty());
  v1::PointBlock other = block_of(5, 1);
  other.mutable_origin()->set_x(11);
  EXPECT_FALSE(points.append(other).ok());
  other = block_of(5, 1);
  other.mutable_attributes()->add_scalars()->set_name("height");
  EXPECT_FALSE(points.append(other).ok());
}

TEST(PointFile, EveryKindIsMade) {
  GatheredPoints points;
  ASSERT_TRUE(points.append(block_of(0, 40)).ok());
  const auto file = [&](const char* ending) {
    const auto made = make_point_file(points.columns(), *find_point_file_kind(ending), {});
    EXPECT_TRUE(made.ok()) << ending << made.status();
    return made.ok() ? made->bytes : "";
  };
  EXPECT_THAT(file("ply"), StartsWith("ply\n"));
  EXPECT_THAT(file("npz"), StartsWith("PK"));
  EXPECT_THAT(file("npy"), StartsWith("\x93NUMPY"));
  EXPECT_THAT(file("glb"), StartsWith("glTF"));
  EXPECT_THAT(file("spz"), StartsWith("\x1f\x8b"));
  EXPECT_THAT(file("las"), StartsWith("LASF"));
  EXPECT_THAT(file("drc"), StartsWith("DRACO"));
  EXPECT_THAT(file("json"), StartsWith("{\"count\":40,"));
  EXPECT_EQ(find_point_file_kind("obj"), nullptr);
  EXPECT_EQ(point_file_endings(), "ply, npz, npy, glb, spz, las, drc, json");
}

TEST(PointFile, ASinglePointIsAFileToo) {
  GatheredPoints points;
  ASSERT_TRUE(points.append(block_of(0, 1)).ok());
  EXPECT_TRUE(make_point_file(points.columns(), *find_point_file_kind("drc"), {}).ok());
}

}  // namespace
}  // namespace curvecast::server
