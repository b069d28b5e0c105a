#include "client/lib/point_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

namespace curvecast::client {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// A folder of its own for every test, gone afterwards.
class PointFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("point_file_test_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::string put(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  std::string get(const std::string& name) const {
    std::ifstream file(path(name), std::ios::binary);
    return std::string((std::istreambuf_iterator<char>(file)), {});
  }
  absl::StatusOr<Points> read(const std::string& name, const std::string& bytes) const {
    return read_point_file(put(name, bytes));
  }

  std::filesystem::path folder_;
};

std::string message_of(const absl::StatusOr<Points>& points) { return std::string(points.status().message()); }

Points some_points(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1, 1);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    points.positions.push_back({unit(random), 1e-3F * unit(random), 1e3F * unit(random)});
    points.normals.push_back({unit(random), unit(random), unit(random)});
    points.radii.push_back(std::abs(unit(random)));
  }
  return points;
}

double coordinate(const Points& points, std::size_t i, int axis) {
  return points.origin[axis] + double{points.positions[i][axis]};
}

TEST_F(PointFile, ReadsBackWhatItWrote) {
  for (const char* ending : {".ply", ".xyz", ".pcd", ".PLY"}) {
    const Points points = some_points(1'000);
    const std::string file = path(std::string("points") + ending);
    ASSERT_TRUE(write_point_file(file, points).ok());
    const absl::StatusOr<Points> back = read_point_file(file);
    ASSERT_TRUE(back.ok()) << back.status();
    EXPECT_EQ(back->origin, points.origin) << ending;
    EXPECT_EQ(back->positions, points.positions) << ending;
    EXPECT_EQ(back->normals, points.normals) << ending;
    if (std::string(ending) == ".xyz") {
      EXPECT_TRUE(back->radii.empty());
    } else {
      EXPECT_EQ(back->radii, points.radii) << ending;
    }
  }
}

Points coloured(Points points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    points.colours.push_back({static_cast<std::uint8_t>(i), 0, static_cast<std::uint8_t>(255 - i % 256)});
  }
  return points;
}

TEST_F(PointFile, ColoursComeBack) {
  const Points points = coloured(some_points(300));
  Points bare = points;
  bare.normals.clear();
  bare.radii.clear();
  for (const char* name : {"a.ply", "a.xyz", "a.pcd"}) {
    for (const Points& written : {points, bare}) {
      ASSERT_TRUE(write_point_file(path(name), written).ok());
      const absl::StatusOr<Points> back = read_point_file(path(name));
      ASSERT_TRUE(back.ok()) << back.status();
      EXPECT_EQ(back->positions, points.positions) << name;
      EXPECT_EQ(back->colours, points.colours) << name;
    }
  }
}

TEST_F(PointFile, ColouredLayoutsAreWhatOtherProgramsExpect) {
  Points points;
  points.positions = {{1.5F, -2, 0.1F}};
  points.normals = {{0, 0, 1}};
  points.radii = {0.25F};
  points.colours = {{255, 128, 7}};
  for (const char* name : {"a.ply", "a.pcd", "a.xyz"}) ASSERT_TRUE(write_point_file(path(name), points).ok());
  EXPECT_THAT(get("a.ply"), HasSubstr("property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                                      "property float radius\n"));
  EXPECT_THAT(get("a.ply"), EndsWith(std::string("\x00\x00\x80\x3f\xff\x80\x07\x00\x00\x80\x3e", 11)));
  EXPECT_THAT(get("a.pcd"), HasSubstr("FIELDS x y z normal_x normal_y normal_z rgb radius\nSIZE 4 4 4 4 4 4 4 4\n"
                                      "TYPE F F F F F F U F\nCOUNT 1 1 1 1 1 1 1 1\n"));
  EXPECT_THAT(get("a.pcd"), EndsWith(std::string("\x00\x00\x80\x3f\x07\x80\xff\x00\x00\x00\x80\x3e", 12)));
  EXPECT_EQ(get("a.xyz"), "1.5 -2 0.1 0 0 1 255 128 7\n");
}

TEST_F(PointFile, DirectionsAndNamedValuesAreColumnsOfPly) {
  Points points = some_points(2);
  points.directions = {{1, 0, 0}, {0, 0.5F, -1}};
  points.scalars = {{"heat", {8, NAN}}, {"a b\n\u00e9", {8, 9}}};
  ASSERT_TRUE(write_point_file(path("a.ply"), points).ok());
  EXPECT_THAT(get("a.ply"), HasSubstr("property float radius\nproperty float direction_min_x\nproperty float direction_min_y\n"
                                      "property float direction_min_z\nproperty float scalar_heat\nproperty float scalar_a_b___\n"
                                      "end_header\n"));
  float last[5];
  const std::string bytes = get("a.ply");
  std::memcpy(last, bytes.data() + bytes.size() - sizeof(last), sizeof(last));
  EXPECT_EQ((std::vector<float>{last[0], last[1], last[2], last[4]}), (std::vector<float>{0, 0.5F, -1, 9}));
  EXPECT_TRUE(std::isnan(last[3]));
  EXPECT_EQ(read_point_file(path("a.ply"))->positions, points.positions);
  points.scalars[1].values.pop_back();
  EXPECT_THAT(std::string(write_point_file(path("a.ply"), points).message()),
              HasSubstr("2 positions do not go with 1 values of a b"));
  points.scalars.clear();
  points.directions.pop_back();
  EXPECT_THAT(std::string(write_point_file(path("a.ply"), points).message()), HasSubstr("1 directions"));
}

TEST_F(PointFile, ReadsColoursOfOthers) {
  const std::string ascii = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string pcd = "FIELDS x y z rgb\nSIZE 4 4 4 4\nWIDTH 1\nHEIGHT 1\n";
  const std::string place(12, '\0');
  for (const auto& [name, bytes] : std::vector<std::array<std::string, 2>>{
           {"a.ply", ascii + "property uchar blue\nproperty uchar green\nproperty uchar red\nproperty uchar alpha\nend_header\n"
                             "1 2 3 7 128 255 9\n"},
           {"a.ply", ascii + "property float red\nproperty float green\nproperty float blue\nend_header\n1 2 3 2 0.502 0.0275\n"},
           {"a.xyz", "1 2 3 0 0 1 255 128 7\n"},
           {"a.pcd", pcd + "TYPE F F F U\nDATA ascii\n1 2 3 16744455\n"},
           {"a.pcd", pcd + "TYPE F F F U\nDATA binary\n" + place + "\x07\x80\xff\x7f"},
           // As PCL writes them: the bits of a float, which need not be a number.
           {"a.pcd", pcd + "TYPE F F F F\nDATA binary\n" + place + "\x07\x80\xff\xff"},
           {"a.pcd", pcd + "TYPE F F F F\nDATA ascii\n1 2 3 2.3463979077456005e-38\n"}}) {
    const absl::StatusOr<Points> points = read(name, bytes);
    ASSERT_TRUE(points.ok()) << points.status() << "\n" << bytes;
    EXPECT_EQ(points->colours, (std::vector<std::array<std::uint8_t, 3>>{{255, 128, 7}})) << bytes;
  }
  for (const auto& [name, bytes] : std::vector<std::array<std::string, 2>>{
           {"a.ply", ascii + "property uchar red\nproperty uchar green\nend_header\n1 2 3 7 128\n"},
           {"a.xyz", "1 2 3 0 0 1 255 128\n"},
           {"a.xyz", "1 2 3 255 128 7\n"}}) {
    const absl::StatusOr<Points> points = read(name, bytes);
    ASSERT_TRUE(points.ok()) << points.status() << "\n" << bytes;
    EXPECT_TRUE(points->colours.empty()) << bytes;
  }
}

TEST_F(PointFile, NormalsAndRadiiMayBeMissing) {
  Points points = some_points(50);
  points.normals.clear();
  points.radii.clear();
  for (const char* name : {"a.ply", "a.xyz"}) {
    ASSERT_TRUE(write_point_file(path(name), points).ok());
    const absl::StatusOr<Points> back = read_point_file(path(name));
    ASSERT_TRUE(back.ok()) << back.status();
    EXPECT_EQ(back->positions, points.positions);
    EXPECT_TRUE(back->normals.empty());
    EXPECT_TRUE(back->radii.empty());
  }
}

// A metre-sized thing in map coordinates: floats around zero would be half a metre coarse.
TEST_F(PointFile, AnOriginFarAwayKeepsItsDigits) {
  Points points = some_points(500);
  for (auto& p : points.positions) p[2] *= 1e-3F;
  points.origin = {4'000'000.125, -5'500'000.5, 123.25};
  for (const char* name : {"a.ply", "a.xyz"}) {
    ASSERT_TRUE(write_point_file(path(name), points).ok());
    const absl::StatusOr<Points> back = read_point_file(path(name));
    ASSERT_TRUE(back.ok()) << back.status();
    ASSERT_EQ(back->size(), points.size());
    EXPECT_EQ(back->normals, points.normals);
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(coordinate(*back, i, axis), coordinate(points, i, axis), 2e-7) << name;
    }
  }
  ASSERT_TRUE(write_point_file(path("a.pcd"), points).ok());
  const absl::StatusOr<Points> coarse = read_point_file(path("a.pcd"));
  ASSERT_TRUE(coarse.ok()) << coarse.status();
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(coordinate(*coarse, i, 0), coordinate(points, i, 0), 0.25);
}

TEST_F(PointFile, NoPointsAtAll) {
  for (const char* name : {"a.ply", "a.pcd"}) {
    ASSERT_TRUE(write_point_file(path(name), Points{}).ok());
    const absl::StatusOr<Points> back = read_point_file(path(name));
    ASSERT_TRUE(back.ok()) << back.status();
    EXPECT_EQ(back->size(), 0U);
  }
}

TEST_F(PointFile, LayoutsAreWhatOtherProgramsExpect) {
  Points points;
  points.positions = {{1.5F, -2, 0.1F}};
  points.normals = {{0, 0, 1}};
  points.radii = {0.25F};
  ASSERT_TRUE(write_point_file(path("a.ply"), points).ok());
  ASSERT_TRUE(write_point_file(path("a.pcd"), points).ok());
  ASSERT_TRUE(write_point_file(path("a.xyz"), points).ok());
  const float record[] = {1.5F, -2, 0.1F, 0, 0, 1, 0.25F};
  const std::string bytes(reinterpret_cast<const char*>(record), sizeof(record));
  EXPECT_EQ(get("a.ply"),
            "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
            "property float nx\nproperty float ny\nproperty float nz\nproperty float radius\nend_header\n" +
                bytes);
  EXPECT_EQ(get("a.pcd"),
            "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z normal_x normal_y normal_z radius\n"
            "SIZE 4 4 4 4 4 4 4\nTYPE F F F F F F F\nCOUNT 1 1 1 1 1 1 1\nWIDTH 1\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\n"
            "DATA binary\n" +
                bytes);
  EXPECT_EQ(get("a.xyz"), "1.5 -2 0.1 0 0 1\n");
  points.origin = {10, 0, 0};
  ASSERT_TRUE(write_point_file(path("a.ply"), points).ok());
  EXPECT_THAT(get("a.ply"), HasSubstr("property double x\nproperty double y\nproperty double z\nproperty float nx"));
}

TEST_F(PointFile, ReadsFilesOfOthers) {
  for (const auto& [name, bytes] : std::vector<std::array<std::string, 2>>{
           {"a.ply",
            "ply\r\nformat ascii 1.0\r\ncomment c\r\nelement vertex 2\r\nproperty double x\r\nproperty uchar red\r\nproperty int "
            "y\r\n"
            "property float z\r\nelement face 0\r\nproperty list uchar int vertex_indices\r\nend_header\r\n1.5 255 2 3\r\n-1 0 5 "
            "6\r\n"},
           {"a.ply",
            "ply\nformat ascii 1.0\nelement camera 2\nproperty list uchar int a\nelement vertex 2\nproperty float z\nproperty "
            "float y\n"
            "property float x\nend_header\n3 1 2 3\n0\n3 2 1.5 9\n6 5 -1\n"},
           {"a.ply",
            "ply\nformat binary_little_endian 1.0\nelement camera 1\nproperty short a\nelement vertex 2\nproperty char z\n"
            "property short y\nproperty float x\nend_header\n" +
                std::string("\x07\x07\x03\x02\x00\x00\x00\xc0\x3f\x06\x05\x00\x00\x00\x80\xbf", 16)},
           {"a.xyz", "# a comment\n\n1.5 2 3\n  -1\t5   6\r\n"},
           {"a.xyz", "1.5 2 3 77\n-1 5 6 78"},
           {"a.pcd",
            "# c\nVERSION .7\nFIELDS x y z rgb _\nSIZE 4 8 4 4 1\nTYPE F F F U U\nCOUNT 1 1 1 1 3\nWIDTH 2\nHEIGHT 1\n"
            "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n1.5 2 3 4 0 0 0\n-1 5 6 4 1 2 3\n"},
           {"a.pcd", "FIELDS x y z\nSIZE 4 2 1\nTYPE F I I\nWIDTH 1\nHEIGHT 2\nDATA binary\n" +
                         std::string("\x00\x00\xc0\x3f\x02\x00\x03\x00\x00\x80\xbf\x05\x00\x06", 14)}}) {
    const absl::StatusOr<Points> points = read(name, bytes);
    ASSERT_TRUE(points.ok()) << points.status() << "\n" << bytes;
    EXPECT_EQ(points->positions, (std::vector<std::array<float, 3>>{{1.5F, 2, 3}, {-1, 5, 6}})) << bytes;
    EXPECT_EQ(points->origin, (std::array<double, 3>{})) << bytes;
    EXPECT_TRUE(points->normals.empty());
    EXPECT_TRUE(points->radii.empty());
  }
  const absl::StatusOr<Points> normals = read("a.xyz", "1 2 3 0 0 1 255 0 0\n");
  ASSERT_TRUE(normals.ok()) << normals.status();
  EXPECT_EQ(normals->normals, (std::vector<std::array<float, 3>>{{0, 0, 1}}));
}

TEST_F(PointFile, ErrorsNameTheFileAndThePlace) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  const std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nproperty float x\nproperty float y\nproperty float z\n"
      "end_header\n";
  const std::string pcd = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\n";
  for (const auto& [name, bytes, message] : std::vector<std::array<std::string, 3>>{
           {"a.ply", "plo\n", "line 1: a PLY file begins with a line 'ply'"},
           {"a.ply", "ply\nformat ascii 1.0\n", "'end_header' is missing"},
           {"a.ply", "ply\nformat binary_big_endian 1.0\nend_header\n", "line 2: big endian point files are not supported"},
           {"a.ply", "ply\nproperty float x\nend_header\n", "line 2: a property stands before"},
           {"a.ply", "ply\nelement vertex many\nend_header\n", "line 2: expected the number of elements"},
           {"a.ply", "ply\nelement vertex 1\nproperty half x\nend_header\n", "line 3: unknown type"},
           {"a.ply", "ply\nsurprise\nend_header\n", "line 2: unknown keyword"},
           {"a.ply", "ply\nformat ascii 1.0\nend_header\n", "no element 'vertex'"},
           {"a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\nend_header\n1 1\n",
            "lists in the element"},
           {"a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 1\n", "no 'z'"},
           {"a.ply", ply + "1 2 3\n", "ends here at the latest"},
           {"a.ply", ply + "1 2 3000000\n", "line 9: the file ends after 1 of 2 points"},
           {"a.ply", ply + "1 2 3\n1 2\n1", "line 9: expected 3 numbers, found 2"},
           {"a.ply", ply + "1 2 3\n1 b 3\n", "line 9: expected a number in column 2"},
           {"a.ply", ply + "1 2 3\n1 nan 3\n", "line 9: a number is not finite"},
           {"a.ply", ply + "1 2 3\n1 1e300 3\n", "line 9: a number is not finite"},
           {"a.ply", binary + std::string(24, '\0'),
            "point 2: the file ends here at the latest, but its header claims 1000000000"},
           {"a.xyz", "1 2\n", "line 1: expected x y z"},
           {"a.xyz", "# nothing\n", "expected x y z"},
           {"a.xyz", "1 2 3\n1 2\n", "line 2: expected 3 numbers, found 2"},
           {"a.xyz", "1 2 3\n1 2 inf\n", "line 2: a number is not finite"},
           {"a.pcd", pcd, "'DATA' is missing"},
           {"a.pcd", pcd + "DATA binary_compressed\n", "line 5: compressed PCD is not supported"},
           {"a.pcd", pcd + "DATA hex\n", "line 5: expected ascii or binary"},
           {"a.pcd", pcd + "SIZE 4 4\n", "line 5: expected a number from 1"},
           {"a.pcd", pcd + "COUNT 1 1 99999999999\n", "line 5: expected a number from 1"},
           {"a.pcd", pcd + "TYPE F F X\n", "line 5: expected I, U or F"},
           {"a.pcd", pcd + "SIZE 4 4 2\nDATA ascii\n", "a SIZE that its TYPE cannot have"},
           {"a.pcd", pcd + "POINTS 1000000000\nDATA binary\n0123456789ab", "point 1: the file ends here"},
           {"a.pcd", pcd + "COUNT 1000000 1000000 1000000\nDATA ascii\n1 2 3\n", "no 'x'"},
           {"a.pcd", "DATA ascii\n1 2 3\n", "no 'x'"}}) {
    const absl::StatusOr<Points> points = read(name, bytes);
    EXPECT_EQ(points.status().code(), absl::StatusCode::kInvalidArgument) << bytes;
    EXPECT_THAT(message_of(points), StartsWith(path(name) + ": "));
    EXPECT_THAT(message_of(points), HasSubstr(message)) << bytes;
  }
  for (const char* name : {"a.txt", "ply", "a.drc"}) {
    EXPECT_EQ(read(name, "1 2 3").status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(write_point_file(path(name), Points{}).message()), HasSubstr("it has to end in .ply, .xyz or .pcd"));
  }
}

TEST_F(PointFile, EveryPrefixIsAnErrorOrSoundPoints) {
  const Points points = some_points(3);
  for (const char* name : {"a.ply", "a.xyz", "a.pcd"}) {
    ASSERT_TRUE(write_point_file(path(name), points).ok());
    const std::string bytes = get(name);
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      const absl::StatusOr<Points> back = read(name, bytes.substr(0, length));
      if (!back.ok()) {
        EXPECT_THAT(message_of(back), StartsWith(path(name))) << length;
        continue;
      }
      EXPECT_EQ(std::string(name), "a.xyz") << "cut to " << length << " and still read";
      EXPECT_LE(back->size(), points.size());
      EXPECT_TRUE(back->normals.empty() || back->normals.size() == back->size());
    }
  }
}

TEST_F(PointFile, FailedWritesLeaveTheOldFileAlone) {
  const Points points = some_points(10);
  ASSERT_TRUE(write_point_file(path("a.ply"), points).ok());
  const std::string before = get("a.ply");
  Points broken = points;
  broken.normals.pop_back();
  const absl::Status status = write_point_file(path("a.ply"), broken);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr("10 positions do not go with 9 normals, 10 radii and 0 colours"));
  EXPECT_EQ(get("a.ply"), before);

  const absl::Status nowhere = write_point_file(path("missing/a.ply"), points);
  EXPECT_FALSE(nowhere.ok());
  EXPECT_THAT(std::string(nowhere.message()), StartsWith(path("missing/a.ply") + ": "));
  EXPECT_THAT(std::string(nowhere.message()), HasSubstr(std::strerror(ENOENT)));
  std::filesystem::create_directories(path("folder.ply"));
  EXPECT_THAT(std::string(write_point_file(path("folder.ply"), points).message()), HasSubstr(std::strerror(EISDIR)));
  EXPECT_EQ(read_point_file(path("missing.ply")).status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(message_of(read_point_file(path("missing.ply"))), StartsWith(path("missing.ply") + ": "));

  std::size_t files = 0;  // no temporary one is left
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder_)) ++files;
  EXPECT_EQ(files, 2U);
}

}  // namespace
}  // namespace curvecast::client
