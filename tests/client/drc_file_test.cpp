#include "client/lib/drc_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "client/lib/file_bytes.h"
#include "tests/client/sphere_points.h"

namespace curvecast::client {
namespace {

using ::testing::HasSubstr;

TEST(DrcFile, RoundTripAddsTheOrigin) {
  Points points = sphere_points(2000);
  points.origin = {10, 20, 30};
  const auto bytes = make_drc(points, {});
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const auto read = parse_drc(*bytes);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->size(), points.size());
  ASSERT_EQ(read->radii.size(), points.size());
  EXPECT_EQ(read->origin, (std::array<double, 3>{}));
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_NEAR(read->positions[i][axis], points.origin[axis] + points.positions[i][axis], 2e-5);
      ASSERT_NEAR(read->normals[i][axis], points.normals[i][axis], 5e-3);
    }
    ASSERT_NEAR(read->radii[i] / points.radii[i], 1, 2e-3);
  }
}

TEST(DrcFile, SamePointsSameBytes) { EXPECT_EQ(*make_drc(sphere_points(500), {}), *make_drc(sphere_points(500), {})); }

TEST(DrcFile, WritesPointsWithoutNormalsAndRadii) {
  Points points = sphere_points(20);
  points.normals.clear();
  points.radii.clear();
  const auto read = parse_drc(*make_drc(points, {}));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->size(), 20U);
  EXPECT_TRUE(read->normals.empty());
  EXPECT_TRUE(read->radii.empty());
}

TEST(DrcFile, KeepsColours) {
  Points points = sphere_points(700);
  add_colours(&points);
  const auto read = parse_drc(*make_drc(points, {}));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->colours, points.colours);
}

TEST(DrcFile, KeepsZeroRadiiSmall) {
  Points points = sphere_points(3);
  points.radii = {0, 0.5F, 1};
  const auto read = parse_drc(*make_drc(points, {}));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_LT(read->radii[0], 1e-30F);
  EXPECT_NEAR(read->radii[2], 1, 0.2);
}

TEST(DrcFile, RefusesNoPointsAndBadOptions) {
  EXPECT_TRUE(absl::IsInvalidArgument(make_drc({}, {}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(make_drc(sphere_points(3), {.position_bits = 0}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(make_drc(sphere_points(3), {.position_bits = 31}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(make_drc(sphere_points(3), {.normal_bits = 1}).status()));
}

TEST(DrcFile, NamesTheFileInErrors) {
  const std::string path = ::testing::TempDir() + "/curvecast_broken.drc";
  ASSERT_TRUE(write_bytes(path, "DRACO and then nothing of the kind").ok());
  const absl::Status status = read_drc(path).status();
  EXPECT_TRUE(absl::IsInvalidArgument(status));
  EXPECT_THAT(std::string(status.message()), HasSubstr(path));
  EXPECT_TRUE(absl::IsNotFound(read_drc(path + ".missing").status()));
}

}  // namespace
}  // namespace curvecast::client
