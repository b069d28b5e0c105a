#include "client/cli/points_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "client/lib/file_bytes.h"
#include "tests/client/sphere_points.h"

namespace curvecast::cli {
namespace {

std::string temporary(const std::string& name) { return ::testing::TempDir() + "/curvecast_points_io_" + name; }

bool file_holds_points(const std::string& name, const std::string& bytes) {
  const std::string path = temporary(name);
  EXPECT_TRUE(client::write_bytes(path, bytes).ok());
  const auto answer = holds_points(path);
  EXPECT_TRUE(answer.ok()) << answer.status();
  return answer.ok() && *answer;
}

TEST(PointsIo, ReadsWhatItWrites) {
  const client::Points points = client::sphere_points(500);
  for (const std::string ending : {"ply", "xyz", "pcd", "drc", "PLY", "Drc"}) {
    const std::string path = temporary("round_trip." + ending);
    ASSERT_TRUE(check_points_ending(path).ok());
    const absl::Status saved = save_points(path, points, {});
    ASSERT_TRUE(saved.ok()) << saved;
    const auto loaded = load_points(path);
    ASSERT_TRUE(loaded.ok()) << loaded.status();
    ASSERT_EQ(loaded->size(), points.size()) << ending;
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_NEAR(loaded->positions[i][axis] + loaded->origin[axis], points.positions[i][axis], 5e-5) << ending;
      }
    }
    EXPECT_TRUE(*holds_points(path)) << ending;
  }
}

TEST(PointsIo, KnowsItsEndings) {
  for (const char* path : {"a.obj", "a", "a.ply.gz", ".ply", "a.png"}) {
    EXPECT_FALSE(check_points_ending(path).ok()) << path;
    EXPECT_FALSE(check_output_ending(path).ok()) << path;
  }
  for (const char* path : {"a.npy", "a.npz", "a.glb", "a.spz", "a.las", "a.LAS"}) {
    EXPECT_FALSE(check_points_ending(path).ok()) << path << " is not read";
    EXPECT_TRUE(check_output_ending(path).ok()) << path;
  }
}

TEST(PointsIo, WritesOtherEndings) {
  client::Points points = client::sphere_points(50);
  const std::vector<std::pair<std::string, std::string>> beginnings = {
      {"a.npy", "\x93NUMPY"}, {"a.npz", "PK"}, {"a.glb", "glTF"}, {"a.spz", "\x1f\x8b"}, {"a.LAS", "LASF"}};
  for (const auto& [name, beginning] : beginnings) {
    const absl::Status saved = save_points(temporary(name), points, {});
    ASSERT_TRUE(saved.ok()) << saved;
    EXPECT_THAT(*client::read_bytes(temporary(name), 1 << 20), ::testing::StartsWith(beginning));
    EXPECT_TRUE(is_in_order_of_rank(name, false)) << name;
  }
  EXPECT_TRUE(is_in_order_of_rank("a.ply", true));
  for (const char* name : {"a.ply", "a.xyz", "a.pcd", "a.drc"}) EXPECT_FALSE(is_in_order_of_rank(name, false)) << name;
  points.positions[7][1] = NAN;
  EXPECT_THAT(std::string(save_points(temporary("a.las"), points, {}).message()),
              ::testing::HasSubstr("a.las: the position of point 7"));
}

TEST(PointsIo, WritesSplatsWhereTheyBelong) {
  const client::Points points = client::sphere_points(50);
  for (const char* name : {"splats.ply", "splats.glb", "splats.spz"}) {
    EXPECT_TRUE(save_points(temporary(name), points, {.splats = true}).ok()) << name;
  }
  for (const char* name : {"splats.drc", "splats.pcd", "splats.npz", "splats.las"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(save_points(temporary(name), points, {.splats = true}))) << name;
  }
}

TEST(PointsIo, TellsPointsFromMeshes) {
  const std::string head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string tail = "end_header\n0 0 0\n";
  EXPECT_TRUE(file_holds_points("a.ply", head + tail));
  EXPECT_TRUE(file_holds_points("b.ply", head + "element face 0\nproperty list uchar int vertex_indices\n" + tail));
  EXPECT_FALSE(file_holds_points("c.ply", head + "element face 2\r\nproperty list uchar int vertex_indices\r\n" + tail));
  EXPECT_FALSE(file_holds_points("d.ply", head + "element tristrips 1\nproperty list int int vertex_indices\n" + tail));
  EXPECT_FALSE(file_holds_points("e.ply", "no PLY file at all")) << "the mesh reader says what is wrong";
  EXPECT_FALSE(file_holds_points("f.ply", head)) << "the header never ends";
  EXPECT_FALSE(file_holds_points("g.obj", "v 0 0 0\n"));
  EXPECT_TRUE(file_holds_points("h.xyz", "0 0 0\n"));
  EXPECT_TRUE(absl::IsNotFound(holds_points(temporary("missing.ply")).status()));
}

}  // namespace
}  // namespace curvecast::cli
