// curvecast measure, on the command's own points and on others.
#include <signal.h>

#include <fstream>

#include "tests/client/cli_fixture.h"

namespace curvecast::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string sampled(const std::string& mesh, const std::string& points, const std::string& ending = ".ply") {
  const std::string path = temporary("measured_" + points + ending);
  EXPECT_EQ(run({"sample", mesh, "-n", points, "-o", path}).status, 0);
  return path;
}

std::string written(const std::string& name, const std::string& text) {
  const std::string path = temporary(name);
  std::ofstream(path) << text;
  return path;
}

TEST_F(CliTest, MeasureTellsAllOfASet) {
  const json report = run_json({"measure", sphere_, sampled(sphere_, "5000")});
  expect_keys(report, {"file", "points", "on_surface", "ring_discrepancy", "ball_discrepancy", "spacing", "seed", "seconds"});
  expect_keys(report["on_surface"], {"max", "mean"});
  expect_keys(report["ring_discrepancy"], {"max", "rms", "rms_relative"});
  expect_keys(report["ball_discrepancy"], {"max", "rms", "rms_relative"});
  expect_keys(report["spacing"], {"rho", "rho_same_side", "nn_mean", "nn_max", "coverage"});
  EXPECT_FALSE(report.contains("gradient"));
  EXPECT_EQ(report["points"], 5000);
  EXPECT_LT(report["on_surface"]["max"], 1e-4);
  EXPECT_LT(report["ball_discrepancy"]["rms_relative"], 0.3);
  EXPECT_LT(report["spacing"]["coverage"], 4);
}

TEST_F(CliTest, MeasureTellsHowFarAnotherMeshLies) {
  const std::string other = temporary("measured_mesh.obj");
  ASSERT_EQ(run({"remesh", sphere_, "-n", "800", "-o", other}).status, 0);
  const json report = run_json({"measure", sphere_, "--mesh", other, "--distance-samples", "20000"});
  expect_keys(report, {"distance", "seed", "seconds"});
  const json& distance = report["distance"];
  expect_keys(distance, {"file", "max", "diagonal", "from_mesh", "from_other"});
  expect_keys(distance["from_mesh"], {"max", "mean", "rms", "farthest", "normal_mean", "normal_rms"});
  EXPECT_GT(distance["from_mesh"]["mean"], 0.01);
  EXPECT_LT(distance["max"], 2);
  const json seen = run_json({"measure", sphere_, "--mesh", other, "--camera", "fov=20"})["distance"]["from_mesh"]["picture"];
  expect_keys(seen, {"max", "mean", "rms", "share"});
  EXPECT_GT(seen["mean"], 0);
  const json both = run_json({"measure", sphere_, sampled(sphere_, "500"), "--mesh", other, "--distance-samples", "20000"});
  EXPECT_EQ(both["distance"], distance);
  EXPECT_EQ(both["points"], 500);
  EXPECT_THAT(run({"measure", sphere_, "--mesh", other}).out, HasSubstr("measured_mesh.obj, % of the diagonal"));
  const Finished nothing = run({"measure", sphere_});
  EXPECT_EQ(nothing.status, 2);
  EXPECT_THAT(nothing.err, HasSubstr("POINTS, or another mesh with --mesh, is required"));
}

TEST_F(CliTest, MeasureOfSeveralSetsTellsTheirGradient) {
  const std::vector<std::string> sets = {sampled(sphere_, "1000"), sampled(sphere_, "4000", ".xyz"),
                                         sampled(sphere_, "16000", ".drc")};
  std::vector<std::string> arguments = {"measure", sphere_};
  arguments.insert(arguments.end(), sets.begin(), sets.end());
  const json report = run_json(arguments);
  ASSERT_EQ(report["sets"].size(), 3u);
  EXPECT_EQ(report["sets"][1]["points"], 4000);
  EXPECT_EQ(report["sets"][2]["file"], sets[2]);
  expect_keys(report["gradient"], {"ring_max", "ring_rms", "ball_max", "ball_rms"});
  EXPECT_NEAR(report["gradient"]["ball_rms"].get<double>(), -0.75, 0.15);
  const Finished text = run(arguments);
  EXPECT_THAT(text.out, HasSubstr("measured_4000.xyz"));
  EXPECT_THAT(text.out, HasSubstr("gradient"));
  EXPECT_THAT(text.err, HasSubstr("rings"));
  arguments.emplace_back("--quiet");
  EXPECT_THAT(run(arguments).err, IsEmpty());
}

TEST_F(CliTest, MeasureFollowsSeedAndDensity) {
  const std::string points = sampled(sphere_, "2000");
  const auto rms = [&](std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"measure", sphere_, points});
    return run_json(flags)["ball_discrepancy"]["rms"].get<double>();
  };
  const double plain = rms({});
  EXPECT_EQ(rms({"--threads", "1"}), plain);
  EXPECT_NE(rms({"--seed", "1"}), plain);
  EXPECT_GT(rms({"--density", "view", "--camera", "eye=0,0,5"}), 5 * plain);
}

TEST_F(CliTest, MeasureSaysWhatIsWrongWithItsFiles) {
  expect_failure({"measure", sphere_, written("one.xyz", "1 0 0\n")}, 3, "one.xyz: holds too few points, 1");
  expect_failure({"measure", sphere_, written("none.xyz", "")}, 3, "none.xyz");
  expect_failure({"measure", sphere_, written("nan.xyz", "1 0 0\nnan 0 0\n")}, 3, "nan.xyz");
  expect_failure({"measure", sphere_, written("text.ply", "hello\n")}, 3, "text.ply");
  expect_failure({"measure", sphere_, temporary("gone.ply")}, 3, "gone.ply");
  expect_failure({"measure", temporary("gone.off"), written("two.xyz", "1 0 0\n0 1 0\n")}, 3, "gone.off");
  expect_failure({"measure", sphere_, sphere_}, 2, ".xyz");
  expect_failure({"measure", sphere_}, 2, "POINTS");
  expect_failure({"measure", sphere_, temporary("two.xyz"), "--ring-seeds", "0"}, 2, "ring-seeds");
  const Finished far = run({"measure", sphere_, written("far.xyz", "3 0 0\n0 3 0\n")});
  EXPECT_EQ(far.status, 0) << far.err;
  EXPECT_THAT(far.err, HasSubstr("were they made for this mesh?"));
}

TEST_F(CliTest, MeasureStopsWhenInterrupted) {
  const std::string points = sampled(sphere_, "2000");
  Process process({"measure", sphere_, points, "--ring-seeds", "100000", "--ball-centres", "100000"});
  ASSERT_TRUE(process.wait_for("balls"));
  process.signal(SIGINT);
  EXPECT_EQ(process.finish().status, 130);
}

}  // namespace
}  // namespace curvecast::cli
