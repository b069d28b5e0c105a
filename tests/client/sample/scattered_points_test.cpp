// Runs `curvecast sample --sampler scattered`, and batch, on generated meshes.
#include <absl/strings/str_cat.h>

#include <fstream>

#include "tests/client/cli_fixture.h"

namespace curvecast::cli {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;

class ScatteredPointsTest : public CliTest {
 protected:
  static std::vector<std::string> scatter(const std::string& mesh, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"sample", mesh, "--sampler", "scattered"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
};

TEST_F(ScatteredPointsTest, AreWrittenWithoutASession) {
  const std::string cache = temporary("untouched");
  for (const char* ending : {"ply", "npz", "glb", "las", "drc"}) {
    const std::string path = temporary(absl::StrCat("points.", ending));
    const json report = run_json(scatter(sphere_, {"-n", "5000", "--relax", "1", "-o", path, "--cache", cache}));
    EXPECT_EQ(report["points"], 5000);
    EXPECT_EQ(report["sampler"], "scattered");
    EXPECT_EQ(report["output"], path);
    expect_keys(report["seconds"], {"read", "scatter", "encode", "total"});
    EXPECT_EQ(report["faces"], 528);
    EXPECT_FALSE(report.contains("session_id") || report.contains("sequence"));
    EXPECT_GT(fs::file_size(path), 5000u);
  }
  EXPECT_FALSE(fs::exists(cache)) << "nothing is kept";
  const Finished text = run(scatter(sphere_, {"-n", "700"}));
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("700 points on 528 triangles"));
}

TEST_F(ScatteredPointsTest, AreTheSameEachTime) {
  const auto make = [](const std::string& name, const std::vector<std::string>& more) {
    const std::string path = temporary(name);
    std::vector<std::string> all = {"-n", "3000", "--relax", "2", "-o", path, "--attributes", "surface,curvatures"};
    all.insert(all.end(), more.begin(), more.end());
    const Finished finished = run(scatter(sphere_, all));
    EXPECT_EQ(finished.status, 0) << finished.err;
    return bytes_of(path);
  };
  const std::string first = make("a.ply", {"--seed", "3", "--threads", "1"});
  EXPECT_TRUE(first == make("b.ply", {"--seed", "3", "--threads", "2"}));
  EXPECT_FALSE(first == make("c.ply", {"--seed", "4"}));
}

TEST_F(ScatteredPointsTest, StandInAnOrderOfWhichEveryPrefixIsEven) {
  const std::string path = temporary("ranked.npz");
  EXPECT_EQ(run(scatter(sphere_, {"-n", "2000", "-o", path})).status, 0);
  EXPECT_THAT(bytes_of(path), HasSubstr("ranks.npy"));
  const std::string ply = temporary("ranked.ply");
  EXPECT_EQ(run(scatter(sphere_, {"-n", "2000", "--attributes", "rank", "-o", ply})).status, 0);
  EXPECT_THAT(bytes_of(ply), HasSubstr("rank"));
  const std::string plain = temporary("plain.ply");
  EXPECT_EQ(run(scatter(sphere_, {"-n", "2000", "-o", plain})).status, 0);
  EXPECT_THAT(bytes_of(plain), ::testing::Not(HasSubstr("rank")));
}

TEST_F(ScatteredPointsTest, FollowCameras) {
  const auto mean_z = [](const std::vector<std::string>& more) {
    const std::string path = temporary("view.xyz");
    std::vector<std::string> all = {"-n", "500", "-o", path};
    all.insert(all.end(), more.begin(), more.end());
    const Finished finished = run(scatter(sphere_, all));
    EXPECT_EQ(finished.status, 0) << finished.err;
    std::ifstream in(path);
    double sum = 0, x = 0, y = 0, z = 0;
    std::string rest;
    for (int i = 0; i < 500; ++i) {
      in >> x >> y >> z;
      std::getline(in, rest);
      sum += z;
    }
    EXPECT_TRUE(in.good());
    return sum / 500;
  };
  EXPECT_NEAR(mean_z({}), 0, 0.05);
  EXPECT_GT(mean_z({"--density", "view", "--camera", "eye=0,0,5"}), 0.2);
  EXPECT_LT(mean_z({"--density", "view", "--camera", "eye=0,0,-5"}), -0.2);
}

TEST_F(ScatteredPointsTest, WhatExcludesEachOtherIsSaid) {
  const auto expect = [](const std::vector<std::string>& more, const std::string& message) {
    expect_failure(scatter(sphere_, more), 3, message);
  };
  expect({"--pixel-error", "3"}, "so many points as -n says");
  expect({"--max-bytes", "3000"}, "so many points as -n says");
  expect({"-n", "10", "--sequence", "golden"}, "--sequence");
  expect({"-n", "10", "--omega", "20"}, "--omega");
  expect({"-n", "10", "--base-density", "curvature"}, "--base-density");
  expect_failure({"stream", sphere_, "--sampler", "scattered"}, 2, "there are: equalised, progressive");
  expect_failure({"sample", sphere_, "-n", "10", "--sampler", "x"}, 2, "there are: equalised, progressive, scattered");
}

TEST_F(ScatteredPointsTest, OfManyMeshesAreThoseOfEach) {
  const std::string list = temporary("scattered.jsonl"), out = temporary("scattered"), cache = temporary("kept");
  write_sphere("b.off", 10);
  std::ofstream(list) << "sphere.off\n{\"mesh\": \"b.off\", \"relax\": 2, \"seed\": 5, \"crease\": 20}\n";
  const std::vector<std::string> batch = {"batch",     list,        "--out",    out,   "-n",      "800",
                                          "--sampler", "scattered", "--format", "npz", "--cache", cache};
  EXPECT_EQ(run_json(batch)["made"], 2);
  EXPECT_EQ(run_json(batch)["kept"], 2) << "though there are no sessions";
  const auto expect_same = [&](const std::string& mesh, const std::vector<std::string>& more, const std::string& name) {
    const std::string path = temporary("one.npz");
    std::vector<std::string> all = {"-n", "800", "-o", path};
    all.insert(all.end(), more.begin(), more.end());
    EXPECT_EQ(run(scatter(mesh, all)).status, 0);
    EXPECT_TRUE(bytes_of(path) == bytes_of(out + "/" + name)) << name;
  };
  expect_same(sphere_, {}, "sphere.npz");
  expect_same(temporary("b.off"), {"--relax", "2", "--seed", "5", "--crease", "20"}, "b.npz");
  std::vector<std::string> relaxed = batch;
  relaxed.insert(relaxed.end(), {"--relax", "1"});
  EXPECT_EQ(run_json(relaxed)["made"], 1) << "what is made otherwise is made anew";
  expect_failure({"batch", list, "--out", out, "--sampler", "scattered", "--format", "none", "--cache", cache}, 3,
                 "sessions only");
}

}  // namespace
}  // namespace curvecast::cli
