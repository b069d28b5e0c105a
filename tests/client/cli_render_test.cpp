// Runs the real command's `render` on a generated sphere.
#include <cstdlib>
#include <fstream>
#include <set>

#include "tests/client/cli_fixture.h"

namespace curvecast::cli {
namespace {

TEST_F(CliTest, RenderDrawsMeshesAndPoints) {
  const std::string png = temporary("picture.png");
  const auto check = [&](const std::vector<std::string>& arguments) {
    std::filesystem::remove(png);
    std::vector<std::string> all = {"render", "-o", png, "--size", "64x48"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const json report = run_json(all);
    EXPECT_EQ(report["width"], 64);
    const std::string bytes = bytes_of(png);
    ASSERT_GT(bytes.size(), 24U);
    EXPECT_EQ(bytes.substr(1, 3), "PNG");
    EXPECT_EQ(bytes.substr(16, 8), std::string("\0\0\0\x40\0\0\0\x30", 8));
  };
  check({sphere_, "-n", "5000"});
  check({sphere_, "-n", "500", "--style", "dots", "--density", "view", "--camera", "fov=20"});
  EXPECT_EQ(run_json({"render", sphere_, "--what", "uv", "-o", png, "--size", "64x64"})["drawn"], 1);
  EXPECT_EQ(bytes_of(png).substr(1, 3), "PNG");
  for (const std::string ending : {"jpg", "jpeg"}) {
    const std::string jpeg = temporary("picture." + ending);
    for (const std::string what : {"surface", "shaded", "uv"}) {
      std::filesystem::remove(jpeg);
      run_json({"render", sphere_, "--what", what, "-o", jpeg, "--size", "64x64"});
      EXPECT_EQ(bytes_of(jpeg).substr(0, 3), "\xFF\xD8\xFF") << what;
    }
  }
  check({sphere_, "--what", "cut", "-n", "5000"});
  check({sphere_, "--what", "shaded", "--camera", "fov=20"});
  for (const std::string ending : {"ply", "xyz", "pcd", "drc"}) {
    const std::string path = temporary("render." + ending);
    run_json({"sample", sphere_, "-n", "2000", "-o", path});
    check({path});
    expect_failure({"render", path, "--what", "cut", "-o", png}, 3, "needs a mesh");
    expect_failure({"render", path, "--what", "shaded", "-o", png}, 3, "needs a mesh");
  }
}

TEST_F(CliTest, RenderDrawsTheStagesOfPreprocessing) {
  const std::string png = temporary("stage.png");
  std::set<std::string> pictures;
  const auto draw = [&](std::vector<std::string> arguments) {
    for (const char* argument : {"-o", png.c_str(), "--size", "160x120"}) arguments.emplace_back(argument);
    arguments.insert(arguments.begin(), {"render", sphere_, "--what"});
    const json report = run_json(arguments);
    EXPECT_EQ(report["width"], 160);
    EXPECT_TRUE(pictures.insert(bytes_of(png)).second) << ::testing::PrintToString(arguments);
    return report;
  };
  EXPECT_EQ(draw({"samples"})["points"], 1500);
  EXPECT_EQ(draw({"samples", "-n", "200"})["points"], 200);
  EXPECT_EQ(draw({"mesh"})["faces"], 2 * 24 + 2 * 10 * 24);
  EXPECT_EQ(draw({"shaded"})["faces"], 2 * 24 + 2 * 10 * 24);
  const json curve = draw({"curve"});
  EXPECT_GT(curve["curve_vertices"], 1000);
  EXPECT_LT(curve["curve_vertices"], 12'000);
  EXPECT_EQ(curve["discs"], 1);
  EXPECT_EQ(draw({"surface-curve"})["curve_vertices"], curve["curve_vertices"]);
  draw({"curve", "--with-mesh"});
  EXPECT_GT(draw({"curve", "--omega", "10"})["curve_vertices"], curve["curve_vertices"]);
  EXPECT_LT(draw({"curve", "-n", "100"})["curve_vertices"], curve["curve_vertices"]);
  draw({"surface-curve", "-n", "100"});
}

TEST_F(CliTest, RenderDrawsThePointsColoursUnlessToldNot) {
  const std::string ply = temporary("plain.ply"), coloured = temporary("coloured.ply");
  run_json({"sample", sphere_, "-n", "2000", "-o", ply});
  auto points = load_points(ply);
  ASSERT_TRUE(points.ok()) << points.status();
  points->colours.assign(points->size(), {0, 0, 255});
  ASSERT_TRUE(save_points(coloured, *points, {}).ok());
  const auto picture = [&](std::vector<std::string> arguments) {
    const std::string png = temporary("colours.png");
    for (const char* argument : {"-o", png.c_str(), "--size", "64x48"}) arguments.emplace_back(argument);
    run_json(arguments);
    return bytes_of(png);
  };
  for (const char* style : {"surface", "dots"}) {
    const std::string plain = picture({"render", ply, "--style", style});
    EXPECT_NE(picture({"render", coloured, "--style", style}), plain);
    EXPECT_EQ(picture({"render", coloured, "--style", style, "--no-colour"}), plain);
  }
}

TEST_F(CliTest, RenderDrawsTheMeshsColoursUnlessToldNot) {
  const std::string off = temporary("coloured.off"), png = temporary("coloured.png");
  std::ofstream(off) << "COFF\n4 2 0\n0 0 0 0 0 255\n1 0 0 0 0 255\n1 1 0 0 0 255\n0 1 0 0 0 255\n3 0 1 2\n3 0 2 3\n";
  const auto picture = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"render", off, "-o", png, "--size", "64x48"});
    run_json(arguments);
    return bytes_of(png);
  };
  const std::string mesh = picture({"--what", "shaded"}), points = picture({"-n", "2000"});
  const std::string plain = picture({"--what", "shaded", "--no-colour"});
  EXPECT_NE(mesh, plain);
  EXPECT_NE(mesh, points);
  EXPECT_EQ(picture({"--what", "shaded", "-n", "77"}), mesh);
  expect_failure({"render", off, "--what", "shaded", "-o", png, "--size", "8000x10"}, 3, "width is 8000");
}

TEST_F(CliTest, WithoutOsmesaThereAreNoPicturesButAllElse) {
  const std::string png = temporary("none.png"), ply = temporary("without.ply"), again = temporary("with.ply");
  ASSERT_EQ(::setenv("CURVECAST_OSMESA", "/nowhere/libOSMesa.so.8", 1), 0);
  expect_failure({"render", sphere_, "-o", png}, 4, "install libosmesa6");
  expect_failure({"render", sphere_, "--what", "shaded", "-o", png}, 4, "install libosmesa6");
  EXPECT_FALSE(std::filesystem::exists(png));
  expect_failure({"preprocess", sphere_, "-n", "500", "--mapper", "id-buffer"}, 4, "install libosmesa6");
  run_json({"sample", sphere_, "-n", "1000", "-o", ply});
  ASSERT_EQ(::setenv("CURVECAST_OSMESA", "libc.so.6", 1), 0);
  expect_failure({"render", sphere_, "-o", png}, 4, "libc.so.6 lacks ");
  ASSERT_EQ(::unsetenv("CURVECAST_OSMESA"), 0);
  run_json({"sample", sphere_, "-n", "1000", "-o", again});
  EXPECT_EQ(bytes_of(ply), bytes_of(again));
}

}  // namespace
}  // namespace curvecast::cli
