// curvecast sample with densities, cameras and budgets of all kinds.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>
#include <utility>

#include "tests/client/cli_fixture.h"

namespace curvecast::cli {
namespace {

/// A unit square of 20 x 20 quads; its vertices are as hot as x.
std::string write_plate(const std::string& name) {
  constexpr int kSide = 20;
  const std::string path = temporary(name);
  std::ofstream file(path);
  file << "ply\nformat ascii 1.0\nelement vertex " << (kSide + 1) * (kSide + 1)
       << "\nproperty float x\nproperty float y\nproperty float z\nproperty float heat\nelement face " << kSide * kSide
       << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (int j = 0; j <= kSide; ++j) {
    for (int i = 0; i <= kSide; ++i) file << i / 20.0 << " " << j / 20.0 << " 0 " << i / 20.0 << "\n";
  }
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const int a = j * (kSide + 1) + i;
      file << "4 " << a << " " << a + 1 << " " << a + kSide + 2 << " " << a + kSide + 1 << "\n";
    }
  }
  return path;
}

TEST_F(CliTest, SampleFollowsAttributes) {
  const std::string plate = write_plate("plate.ply"), path = temporary("heat.ply");
  for (const std::string density : {"attribute:heat", "expression:heat"}) {
    run_json({"sample", plate, "-n", "4000", "--density", density, "--base-density", density, "-o", path});
    const auto points = load_points(path);
    ASSERT_TRUE(points.ok()) << points.status();
    int right = 0;
    for (const auto& p : points->positions) right += p[0] + points->origin[0] > 0.5 ? 1 : 0;
    EXPECT_NEAR(right, 3000, 30) << density;
  }
  expect_failure({"sample", plate, "-n", "10", "--density", "attribute:cold"}, 3, "there are: heat");
  expect_failure({"preprocess", plate, "--base-density", "attribute:cold"}, 3, "there are: heat");
  expect_failure({"measure", plate, path, "--density", "attribute:cold"}, 3, "there are: heat");
  EXPECT_EQ(run({"measure", plate, path, "--density", "attribute:heat"}).status, 0);
}

TEST_F(CliTest, SampleWritesWhatTheMeshHas) {
  const std::string plate = write_plate("plate.ply"), path = temporary("described.ply");
  run_json({"sample", plate, "-n", "500", "--attributes", "directions,scalars", "-o", path});
  const std::string bytes = bytes_of(path);
  EXPECT_THAT(bytes, ::testing::HasSubstr(
                         "property float radius\nproperty float direction_min_x\nproperty float direction_min_y\nproperty "
                         "float direction_min_z\nproperty float scalar_heat\nend_header\n"));
  constexpr std::size_t kRow = 11;  // floats: place, normal, radius, direction, heat
  ASSERT_GT(bytes.size(), 500 * kRow * sizeof(float));
  for (std::size_t i = 0; i < 500; ++i) {
    float row[kRow];
    std::memcpy(row, bytes.data() + bytes.size() - (500 - i) * sizeof(row), sizeof(row));
    EXPECT_NEAR(row[10], row[0], 1e-5) << "as hot as x";
    EXPECT_NEAR(std::hypot(row[7], row[8]), 1, 1e-5) << "along the plate";
  }
  expect_failure({"sample", plate, "-n", "10", "--attributes", "directions,age"}, 2, "age");
}

TEST_F(CliTest, SampleServesSeveralCameras) {
  const std::string path = temporary("cameras.ply");
  run_json({"sample", sphere_, "-n", "2000", "--density", "view", "--density", "frustum", "--camera", "eye=0,0,10,ortho=1",
            "--camera", "eye=10,0,0,ortho=1", "-o", path});
  const auto points = load_points(path);
  ASSERT_TRUE(points.ok()) << points.status();
  int front = 0, side = 0;
  for (const auto& p : points->positions) {
    const bool in_front = p[2] > 0 && std::abs(p[0]) < 0.51 && std::abs(p[1]) < 0.51;
    const bool at_side = p[0] > 0 && std::abs(p[1]) < 0.51 && std::abs(p[2]) < 0.51;
    ASSERT_TRUE(in_front || at_side) << p[0] << " " << p[1] << " " << p[2];
    front += in_front ? 1 : 0;
    side += at_side ? 1 : 0;
  }
  EXPECT_NEAR(front, side, 150);
}

TEST_F(CliTest, SampleFollowsBrushesAndFormulas) {
  const std::string path = temporary("painted.ply");
  run_json({"sample", sphere_, "-n", "2000", "--density", "brush:0,0,-1,1.5,0,0", "--density", "expression:y > 0", "-o", path});
  const auto points = load_points(path);
  ASSERT_TRUE(points.ok()) << points.status();
  for (const auto& p : points->positions) ASSERT_TRUE(p[1] > -1e-6 && std::hypot(p[0], p[1], p[2] + 1) > 1.5 - 1e-3);
  const std::string dabs = temporary("dabs.txt");
  std::ofstream(dabs) << "# all away, then half of it back\n0 0 0 9 0\n\n0, 0, 1, 1.4, 1, 0  # a hard edge\n";
  run_json({"sample", sphere_, "-n", "2000", "--density", "brush:@" + dabs, "-o", path});
  const auto kept = load_points(path);
  ASSERT_TRUE(kept.ok()) << kept.status();
  EXPECT_EQ(kept->size(), 2000u);
  for (const auto& p : kept->positions) ASSERT_LT(std::hypot(p[0], p[1], p[2] - 1), 1.4 + 1e-3);
  std::ofstream(dabs) << "0 0 0 9 0\n0 0 0 -9 0\n";
  expect_failure({"sample", sphere_, "-n", "10", "--density", "brush:@" + dabs}, 2, "dabs.txt, line 2: brush: radius=-9");
  expect_failure({"sample", sphere_, "-n", "10", "--density", "brush:@none.txt"}, 2, "'none.txt' cannot be read");
  expect_failure({"sample", sphere_, "-n", "10", "--density", "attribute:heat"}, 3, "no attribute 'heat'");
  expect_failure({"sample", sphere_, "-n", "10", "--density", "expression:1 / (x - x)"}, 3, "infinite at");
  expect_failure({"sample", sphere_, "-n", "10", "--density", "expression:heat"}, 3, "there are: x, y, z");
}

TEST_F(CliTest, SampleFillsAPictureOfAnyShape) {
  const auto widest = [](const std::string& camera) {
    const std::string path = temporary("wide.ply");
    run_json({"sample", sphere_, "-n", "4000", "--density", "frustum", "--density", "view", "--camera", camera, "-o", path});
    const auto points = load_points(path);
    EXPECT_TRUE(points.ok()) << points.status();
    double x = 0, y = 0;
    for (const auto& p : points->positions) {
      x = std::max(x, std::abs(static_cast<double>(p[0]) / (3 - static_cast<double>(p[2]))));
      y = std::max(y, std::abs(static_cast<double>(p[1]) / (3 - static_cast<double>(p[2]))));
    }
    return std::pair(x, y);
  };
  const double half = std::tan(5 * std::acos(-1) / 180);
  const auto [x, y] = widest("eye=0,0,3,fov=10");
  EXPECT_NEAR(x, half, 0.05 * half);
  EXPECT_NEAR(y, half, 0.05 * half);
  const auto [wide_x, wide_y] = widest("eye=0,0,3,fov=10,aspect=2");
  EXPECT_NEAR(wide_x, 2 * half, 0.1 * half);
  EXPECT_NEAR(wide_y, half, 0.05 * half);
  expect_failure({"sample", sphere_, "-n", "9", "--density", "view", "--camera", "aspect=2", "--camera", "fov=30"}, 3,
                 "the same aspect");
  expect_failure({"render", sphere_, "-o", temporary("wide.png"), "--camera", "aspect=2"}, 3, "leave aspect= out");
}

TEST_F(CliTest, SampleTakesABudget) {
  const auto count = [](const std::vector<std::string>& flags) {
    std::vector<std::string> arguments = {"sample", sphere_, "--density", "screen", "--camera", "eye=0,0,3"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    return run_json(arguments)["points"].get<int>();
  };
  const int coarse = count({"--pixel-error", "20"}), fine = count({"--pixel-error", "10"});
  EXPECT_GT(coarse, 100);
  EXPECT_NEAR(fine, 4 * coarse, 0.01 * fine);
  const int few = count({"--max-bytes", "10000"}), many = count({"--max-bytes", "40000"});
  EXPECT_GT(few, 1000);
  EXPECT_GT(many, 3.5 * few);
  EXPECT_EQ(count({"--density", "distance:1.5,global", "-n", "4000"}), 1000);
  EXPECT_EQ(count({"--density", "distance:1.5,global=inverse", "-n", "4000"}), 2000);
  EXPECT_EQ(count({"--density", "distance:1,5,global=linear", "-n", "4000"}), 2000);
}

}  // namespace
}  // namespace curvecast::cli
