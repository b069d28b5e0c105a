// Runs the real command on a generated sphere.
#include <signal.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <numbers>

#include "tests/client/cli_fixture.h"

namespace curvecast::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

TEST_F(CliTest, HelpTellsAboutEveryCommand) {
  const Finished help = run({"--help"});
  EXPECT_EQ(help.status, 0);
  for (const std::string command : {"serve", "info", "preprocess", "sample", "batch", "stream", "measure", "render", "bench"}) {
    EXPECT_THAT(help.out, HasSubstr(command));
    const Finished own = run({command, "--help"});
    EXPECT_EQ(own.status, 0);
    EXPECT_THAT(own.out, HasSubstr("Examples:"));
    EXPECT_THAT(own.out, HasSubstr("--server"));
  }
  EXPECT_THAT(run({"sample", "--help"}).out, HasSubstr("1 to 4,000,000"));
  EXPECT_THAT(run({"--version"}).out, StartsWith("curvecast "));
}

TEST_F(CliTest, InfoSaysWhatTheFileHolds) {
  const json info = run_json({"info", sphere_});
  EXPECT_EQ(info["name"], "sphere.off");
  EXPECT_EQ(info["format"], "off");
  EXPECT_EQ(info["mesh"]["components"], 1);
  EXPECT_EQ(info["mesh"]["genus"], 0);
  EXPECT_EQ(info["mesh"]["boundary_loops"], 0);
  EXPECT_EQ(info["mesh"]["vertices"], 2 + 11 * 24);
  EXPECT_NEAR(info["area"].get<double>(), 4 * std::numbers::pi, 0.3);
  EXPECT_EQ(info["repairs"]["triangulated_polygons"], 10 * 24);
  EXPECT_NEAR(info["box"]["max"][2].get<double>(), 1, 1e-9);
  const Finished text = run({"info", sphere_});
  EXPECT_EQ(text.status, 0);
  EXPECT_THAT(text.out, HasSubstr("genus 0"));
}

TEST_F(CliTest, PreprocessReportsItsStages) {
  const json report = run_json({"preprocess", sphere_, "-n", "5000", "--omega", "8"});
  expect_keys(report, {"mesh", "repairs", "discs", "curve_vertices", "omega", "points", "max_level", "flipped_triangles",
                       "area_error", "distortion", "fallback_discs", "seconds", "curve_bytes", "peak_bytes"});
  expect_keys(report["mesh"], {"vertices", "faces", "components", "genus", "boundary_loops"});
  expect_keys(report["distortion"], {"p50", "p99", "p999", "density_p999", "max", "extra_levels_mean", "extra_levels_max"});
  expect_keys(report["seconds"], {"read", "repair", "cut", "parameterise", "curve", "map", "area", "total"});
  EXPECT_EQ(report["omega"], 8);
  EXPECT_EQ(report["points"], 5000);
  EXPECT_EQ(report["flipped_triangles"], 0);
  const Finished text = run({"preprocess", sphere_, "-n", "5000"});
  EXPECT_THAT(text.out, HasSubstr("parameterise"));
  EXPECT_THAT(text.err, HasSubstr("curve")) << "plain lines where there is no terminal";
  EXPECT_THAT(run({"preprocess", sphere_, "-n", "5000", "--quiet"}).err, IsEmpty());
}

TEST_F(CliTest, ASecondRunTakesTheSessionFromTheCache) {
  const std::string cache = temporary("cache_of_two_runs");
  const std::vector<std::string> command = {"preprocess", sphere_, "-n", "3000", "--cache", cache};
  const json first = run_json(command), second = run_json(command);
  EXPECT_EQ(first.value("cached", true), false);
  EXPECT_EQ(second.value("cached", false), true);
  EXPECT_EQ(first["seconds"], second["seconds"]) << "those of the run that made it";
  EXPECT_EQ(first["session_id"], second["session_id"]);
  const Finished third = run(command);
  EXPECT_THAT(third.err, HasSubstr("load"));
  EXPECT_THAT(third.err, HasSubstr("taken from the cache"));
  const std::vector<std::string> sample = {"sample", sphere_, "-n", "2000", "-o"};
  std::string bytes;
  for (const std::vector<std::string>& flags :
       std::vector<std::vector<std::string>>{{"--no-cache"}, {"--cache", cache}, {"--cache", cache}}) {
    std::vector<std::string> words = sample;
    words.push_back(temporary("of_cache.ply"));
    words.insert(words.end(), flags.begin(), flags.end());
    ASSERT_EQ(run(words).status, 0);
    if (bytes.empty()) bytes = bytes_of(temporary("of_cache.ply"));
    EXPECT_EQ(bytes_of(temporary("of_cache.ply")), bytes);
  }
}

TEST_F(CliTest, TheUsersCacheIsUsedUnlessToldNot) {
  const std::string cache = temporary("cache/curvecast");
  std::filesystem::remove_all(cache);
  EXPECT_EQ(run({"preprocess", sphere_, "-n", "777", "--no-cache"}).status, 0);
  EXPECT_EQ(run({"info", sphere_}).status, 0);
  EXPECT_FALSE(std::filesystem::exists(cache));
  EXPECT_EQ(run({"preprocess", sphere_, "-n", "777"}).status, 0);
  EXPECT_FALSE(std::filesystem::is_empty(cache));
  EXPECT_EQ(std::filesystem::status(cache).permissions(), std::filesystem::perms::owner_all);
}

TEST_F(CliTest, OnlyAFolderThatWasAskedForMustBeUsable) {
  const std::string file = temporary("no_folder");
  std::ofstream(file) << "a file";
  expect_failure({"preprocess", sphere_, "-n", "777", "--cache", file}, 3, "cache folder");
  expect_failure({"serve", "--listen", "127.0.0.1:0", "--cache", file, "--quiet"}, 3, "cache folder");
  ASSERT_EQ(::setenv("XDG_CACHE_HOME", file.c_str(), 1), 0);
  const Finished without = run({"preprocess", sphere_, "-n", "777"});
  ASSERT_EQ(::setenv("XDG_CACHE_HOME", temporary("cache").c_str(), 1), 0);
  EXPECT_EQ(without.status, 0);
  EXPECT_THAT(without.err, HasSubstr("nothing is cached"));
}

TEST_F(CliTest, SampleWritesExactlyNPointsOnTheSphere) {
  for (const std::string ending : {"ply", "xyz", "pcd", "drc"}) {
    const std::string path = temporary("points." + ending);
    const json report = run_json({"sample", sphere_, "-n", "3000", "-o", path, "--seed", "5"});
    expect_keys(report, {"points", "curve_vertices", "seconds", "sampler", "sequence", "seed"});
    expect_keys(report["seconds"], {"preprocess", "density", "equalise", "encode", "total"});
    EXPECT_EQ(report["points"], 3000);
    EXPECT_EQ(report["seed"], 5);
    EXPECT_EQ(report["sampler"], "equalised");
    EXPECT_EQ(report["sequence"], "jittered");
    const auto points = load_points(path);
    ASSERT_TRUE(points.ok()) << points.status();
    ASSERT_EQ(points->size(), 3000U);
    for (const auto& p : points->positions) {
      const double radius = std::hypot(p[0] + points->origin[0], p[1] + points->origin[1], p[2] + points->origin[2]);
      ASSERT_NEAR(radius, 1, 0.03) << ending;
    }
  }
}

TEST_F(CliTest, SampleWithoutOutputOnlyMeasures) {
  for (const char* sequence : {"regular", "vandercorput", "golden", "niederreiter"}) {
    EXPECT_EQ(run_json({"sample", sphere_, "-n", "1", "--sequence", sequence})["sequence"], sequence);
  }
}

TEST_F(CliTest, NiederreiterIsAnotherNameOfVanDerCorput) {
  const auto sample = [&](const std::string& sequence) {
    const std::string path = temporary(sequence + ".xyz");
    run_json({"sample", sphere_, "-n", "500", "--seed", "7", "--sequence", sequence, "-o", path});
    return bytes_of(path);
  };
  EXPECT_EQ(sample("niederreiter"), sample("vandercorput"));
  EXPECT_NE(sample("niederreiter"), sample("golden"));
}

TEST_F(CliTest, TheSameSeedGivesTheSameBytes) {
  for (const std::string sampler : {"equalised", "progressive"}) {
    for (const std::string ending : {"ply", "drc"}) {
      const auto sample = [&](const std::string& seed, const std::string& threads) {
        const std::string path = temporary("same." + ending);
        run_json({"sample", sphere_, "-n", "2000", "--density", "curvature:kind=mean", "--sampler", sampler, "-o", path, "--seed",
                  seed, "--threads", threads});
        return bytes_of(path);
      };
      const std::string first = sample("7", "1");
      EXPECT_EQ(first, sample("7", "2"));
      EXPECT_NE(first, sample("8", "1"));
    }
  }
}

TEST_F(CliTest, ViewDensityLeavesTheBackOut) {
  const std::string path = temporary("view.ply");
  run_json({"sample", sphere_, "-n", "2000", "--density", "view:s0=0.1", "--camera", "eye=0,0,10", "-o", path});
  const auto points = load_points(path);
  ASSERT_TRUE(points.ok()) << points.status();
  for (const auto& p : points->positions) ASSERT_GT(p[2], -0.1);
}

TEST_F(CliTest, StreamMeasuresAPath) {
  const std::string frames = temporary("frames");
  const json report = run_json({"stream", sphere_, "--path", "orbit", "--frames", "40", "-n", "1500", "-o", frames});
  expect_keys(report, {"frames", "points_median", "added_median", "removed_median", "key_bytes", "delta_bytes_median",
                       "bytes_per_point", "server_ms", "latency_ms"});
  EXPECT_EQ(report["frames"], 40);
  EXPECT_EQ(report["points_median"], 1500);
  EXPECT_LT(report["added_median"], 1000);
  EXPECT_NEAR(report["removed_median"].get<double>(), report["added_median"].get<double>(), 50);
  const json whole = run_json({"stream", sphere_, "--path", "orbit", "--frames", "4", "-n", "1500", "--sampler", "equalised"});
  EXPECT_EQ(whole["added_median"], 1500);
  EXPECT_EQ(whole["removed_median"], 1500);
  EXPECT_EQ(run_json({"stream", sphere_, "--frames", "4", "-n", "1500", "--sequence", "golden"})["added_median"], 1500);
  EXPECT_GT(report["latency_ms"]["p99"].get<double>(), 0);
  EXPECT_GE(report["server_ms"]["p99"].get<double>(), report["server_ms"]["p50"].get<double>());
  for (int i = 0; i < 4; ++i) {
    const auto points = load_points(frames + "/frame_000" + std::to_string(i) + ".ply");
    ASSERT_TRUE(points.ok()) << points.status();
    EXPECT_EQ(points->size(), 1500U);
  }
  const std::string views = temporary("views.txt");
  std::ofstream(views) << "# two views\n0 0 5 0 0 0 0 1 0 45\n5 0 0 0 0 0 0 1 0 45\n";
  EXPECT_EQ(run_json({"stream", sphere_, "--path", views, "--frames", "3", "-n", "100", "--density", "uniform"})["frames"], 3);
  EXPECT_EQ(run_json({"stream", sphere_, "--path", "zoom", "--frames", "1", "-n", "100"})["removed_median"], 0);
}

TEST_F(CliTest, SessionsAreMadeAsAskedFor) {
  const json plain = run_json({"preprocess", sphere_, "-n", "500"});
  EXPECT_EQ(plain["mapper"], "exact");
  EXPECT_EQ(plain["area_element"], "exact");
  const json other = run_json({"preprocess", sphere_, "-n", "500", "--mapper", "id-buffer", "--area", "voronoi"});
  EXPECT_EQ(other["mapper"], "id-buffer");
  EXPECT_EQ(other["area_element"], "voronoi");
  const json even = run_json({"preprocess", sphere_, "-n", "500", "--base-density", "uniform"});
  EXPECT_EQ(even["curve_vertices"], plain["curve_vertices"]);
  // A long box: half of its corners are corners, the others lie half way between.
  const std::string box = temporary("box.off");
  std::ofstream(box) << "OFF\n12 10 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 5\n1 0 5\n1 1 5\n0 1 5\n0 0 10\n1 0 10\n1 1 10\n0 1 10\n"
                        "4 3 2 1 0\n4 8 9 10 11\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n"
                        "4 4 5 9 8\n4 5 6 10 9\n4 6 7 11 10\n4 7 4 8 11\n";
  EXPECT_NE(run_json({"preprocess", box, "-n", "5000", "--base-density", "curvature"})["curve_vertices"],
            run_json({"preprocess", box, "-n", "5000"})["curve_vertices"]);
  EXPECT_EQ(run_json({"sample", sphere_, "-n", "500", "--base-density", "curvature:kind=max", "--area", "voronoi"})["points"],
            500);
  EXPECT_EQ(run_json({"stream", sphere_, "--frames", "1", "-n", "100", "--mapper", "id-buffer"})["frames"], 1);
  EXPECT_THAT(run({"preprocess", sphere_, "-n", "500"}).out, HasSubstr("100.0 %"));
}

TEST_F(CliTest, WhatAMeshRefersToIsTakenFromItsFolder) {
  std::filesystem::create_directories(temporary("obj"));
  const std::string obj = temporary("obj/square.obj");
  std::ofstream(temporary("obj/square.mtl")) << "newmtl blue\nKd 0 0 1\nmap_Kd missing.png\n";
  std::ofstream(obj) << "mtllib square.mtl\nusemtl blue\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
  const json info = run_json({"info", obj});
  EXPECT_THAT(info["attributes"].dump(), HasSubstr("materials"));
  EXPECT_THAT(info["warnings"].dump(), HasSubstr("missing.png"));
  EXPECT_THAT(run({"info", obj}).out, HasSubstr("warning        "));
  EXPECT_EQ(run_json({"preprocess", obj, "-n", "100"})["warnings"], info["warnings"]);
  const std::string ply = temporary("square.ply");
  run_json({"sample", obj, "-n", "50", "-o", ply});
  const auto points = load_points(ply);
  ASSERT_TRUE(points.ok()) << points.status();
  EXPECT_EQ(points->colours, (std::vector<std::array<std::uint8_t, 3>>(50, {0, 0, 255})));
}

TEST_F(CliTest, PreprocessTakesCgalsParameteriser) {
  const json own = run_json({"preprocess", sphere_, "-n", "500"});
  const auto vertices = [](const std::vector<std::string>& flags) {
    std::vector<std::string> arguments = {"sample", sphere_, "-n", "500"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    return run_json(arguments)["curve_vertices"].get<int>();
  };
  EXPECT_GT(vertices({"--omega", "20"}), vertices({})) << "other commands take these options too";
  EXPECT_NE(vertices({"--parameteriser", "cgal"}), vertices({}));
  const json cgal = run_json({"preprocess", sphere_, "-n", "500", "--parameteriser", "cgal"});
  EXPECT_EQ(own["parameteriser"], "own");
  EXPECT_EQ(cgal["parameteriser"], "cgal");
  EXPECT_NE(own["session_id"], cgal["session_id"]);
  EXPECT_EQ(cgal["flipped_triangles"], 0);
}

TEST_F(CliTest, MeshesAreDividedIntoCharts) {
  const std::string ball = write_sphere("ball.off", 36);  // 5,040 faces
  EXPECT_EQ(run_json({"preprocess", ball, "-n", "500"})["discs"], 1);
  EXPECT_EQ(run_json({"preprocess", ball, "-n", "500", "--chart-faces", "1260"})["discs"], 4);
  EXPECT_EQ(run_json({"render", ball, "--what", "uv", "--chart-faces", "1260", "-o", temporary("uv.png")})["discs"], 4);
  expect_failure({"preprocess", ball, "--chart-faces", "999"}, 2, "chart-faces");
}

TEST_F(CliTest, EdgesAreSharpFromAnAngleOfChoice) {
  const std::string cube = temporary("cube.off"), ply = temporary("cube.ply");
  std::ofstream(cube) << "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n"
                         "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
  const auto leaning = [&](const std::vector<std::string>& flags) {  // points whose normals are no face's
    std::vector<std::string> arguments = {"sample", cube, "-n", "500", "-o", ply};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    run_json(arguments);
    const auto points = load_points(ply);
    EXPECT_TRUE(points.ok()) << points.status();
    return points.ok() ? std::ranges::count_if(points->normals,
                                               [](const auto& n) {
                                                 return std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])}) < 0.99f;
                                               })
                       : -1;
  };
  EXPECT_EQ(leaning({}), 0);
  EXPECT_EQ(leaning({"--crease", "0"}), 0);
  EXPECT_GT(leaning({"--crease", "100"}), 250);
  const json usual = run_json({"preprocess", cube, "-n", "500"});
  const json sharper = run_json({"preprocess", cube, "-n", "500", "--crease", "12.5"});
  EXPECT_EQ(usual["crease_degrees"], 40);
  EXPECT_EQ(sharper["crease_degrees"], 12.5);
  EXPECT_NE(usual["session_id"], sharper["session_id"]);
  EXPECT_TRUE(usual["mesh"]["crease_degrees"].is_null());
  const std::string flat = temporary("flat.obj");
  std::ofstream(flat) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ns off\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  EXPECT_EQ(run_json({"preprocess", flat, "-n", "500"})["crease_degrees"], 0) << "as its smoothing groups mean";
  EXPECT_EQ(run_json({"preprocess", flat, "-n", "500", "--crease", "40"})["crease_degrees"], 40);
  for (const char* degrees : {"-1", "181", "sharp"}) expect_failure({"preprocess", cube, "--crease", degrees}, 2, "crease");
}

TEST_F(CliTest, BenchMeasuresWithoutAServer) {
  EXPECT_THAT(run({"bench", "--list"}).out, HasSubstr("corpus"));
  const json growth = run_json({"bench", "growth", sphere_, "--levels", "1", "-n", "500"});
  expect_keys(growth, {"name", "machine", "results"});
  expect_keys(growth["results"][0], {"case", "value", "unit"});
  const std::string meshes = temporary("corpus");
  std::filesystem::create_directories(meshes);
  std::filesystem::copy(sphere_, meshes + "/sphere.off");
  const std::string table = temporary("corpus.md");
  EXPECT_EQ(run_json({"bench", "corpus", meshes, "-n", "500", "--out", table})["files"][0]["result"], "passed");
  EXPECT_THAT(bytes_of(table), HasSubstr("| sphere.off | passed |"));
  std::ofstream(meshes + "/broken.off") << "OFF\n1";
  EXPECT_EQ(run({"bench", "corpus", meshes, "-n", "500"}).status, 3);
  const std::string paper = temporary("paper");
  EXPECT_THAT(run({"bench", "paper", "--quick", "--quiet", "--out", paper}).out, HasSubstr(paper + "/paper.html"));
  EXPECT_THAT(bytes_of(paper + "/paper.html"), HasSubstr("Figure"));
  EXPECT_EQ(json::parse(bytes_of(paper + "/paper.json"))["quick"], true);
  expect_failure({"bench", "paper", temporary("missing.off"), "--out", paper}, 3, "missing.off");
  expect_failure({"bench", "paper", "--quick", "--out", sphere_}, 3, sphere_);
  expect_failure({"bench", "growth", sphere_, "--server", "127.0.0.1:1"}, 3, "--server");
  expect_failure({"bench"}, 2, "name a benchmark");
  expect_failure({"bench", "fly"}, 2, "");
}

TEST_F(CliTest, WrongUsageIsStatus2) {
  expect_failure({}, 2, "subcommand");
  expect_failure({"fly"}, 2, "there is no command 'fly'");
  expect_failure({"sample", sphere_}, 2, "-n, --pixel-error or --max-bytes");
  expect_failure({"sample", sphere_, "-n", "10", "--max-bytes", "5000"}, 2, "max-bytes");
  expect_failure({"sample", sphere_, "--pixel-error", "1", "--max-bytes", "5000"}, 2, "max-bytes");
  expect_failure({"sample", sphere_, "--pixel-error", "0"}, 2, "pixel-error");
  expect_failure({"sample", sphere_, "--max-bytes", "1023"}, 2, "max-bytes");
  expect_failure({"render", sphere_, "-o", "x.png", "--camera", "fov=20", "--camera", "fov=30"}, 2, "camera");
  for (const char* n : {"0", "4000001", "-5", "many", "1.5"}) expect_failure({"sample", sphere_, "-n", n}, 2, "");
  expect_failure({"sample", sphere_, "-n", "10", "-o", "x.obj"}, 2, ".ply, .xyz, .pcd, .drc");
  expect_failure({"sample", sphere_, "-n", "10", "--density", "blob"}, 2, "there are: uniform, curvature, attribute");
  expect_failure({"sample", sphere_, "-n", "10", "--sampler", "random"}, 2, "there are: equalised, progressive");
  expect_failure({"sample", sphere_, "-n", "10", "--sequence", "halton"}, 2,
                 "there are: jittered, regular, vandercorput, golden");
  expect_failure({"sample", sphere_, "-n", "10", "--camera", "eye=1"}, 2, "eye takes 3 numbers");
  expect_failure({"preprocess", sphere_, "--omega", "0.5"}, 2, "omega");
  expect_failure({"render", sphere_, "-o", "x.gif"}, 2, ".png");
  expect_failure({"render", sphere_, "-o", "x.png", "--size", "0x10"}, 2, "WIDTHxHEIGHT");
  expect_failure({"render", sphere_, "-o", "x.png", "--what", "hair"}, 2,
                 "there are: surface, shaded, samples, mesh, cut, uv, curve, surface-curve");
  expect_failure({"preprocess", sphere_, "--parameteriser", "magic"}, 2, "there are: own, cgal");
  expect_failure({"preprocess", sphere_, "--mapper", "magic"}, 2, "there are: exact, id-buffer");
  expect_failure({"sample", sphere_, "-n", "10", "--area", "magic"}, 2, "there are: exact, voronoi");
  expect_failure({"sample", sphere_, "-n", "10", "--base-density", "view"}, 2, "cannot depend on a camera");
  expect_failure({"preprocess", sphere_, "--base-density", "curvature:floor=2"}, 2, "from 0 to 1");
  expect_failure({"stream", sphere_, "--frames", "0"}, 2, "frames");
  expect_failure({"info", sphere_, "--quiet", "--verbose"}, 2, "");
}

TEST_F(CliTest, BadInputIsStatus3) {
  for (const char* command : {"info", "preprocess"}) {
    expect_failure({command, "/nonexistent/mesh.off"}, 3, "/nonexistent/mesh.off: cannot be opened: No such file");
  }
  expect_failure({"sample", "/nonexistent/mesh.off", "-n", "5"}, 3, "/nonexistent/mesh.off");
  expect_failure({"info", ::testing::TempDir()}, 3, "is a directory");
  const std::string broken = temporary("broken.off");
  std::ofstream(broken) << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n";
  for (const char* command : {"info", "preprocess"}) expect_failure({command, broken}, 3, "broken.off");
  std::ofstream(broken) << "";
  expect_failure({"info", broken}, 3, "empty");
  const std::string points = temporary("broken.drc");
  std::ofstream(points) << "DRACO nothing of the kind";
  expect_failure({"render", points, "-o", temporary("x.png")}, 3, "broken.drc");
  const std::string views = temporary("broken_views.txt");
  std::ofstream(views) << "1 2 3\n";
  expect_failure({"stream", sphere_, "--path", views}, 3, "line 1");
}

TEST_F(CliTest, AnOutputThatCannotBeWrittenIsFoundOutFirst) {
  // The mesh is missing too: the output is looked at before.
  const std::string output = "/nonexistent/folder/points.ply";
  expect_failure({"sample", "/nonexistent/mesh.off", "-n", "5", "-o", output}, 3, output);
  expect_failure({"render", "/nonexistent/mesh.off", "-o", "/nonexistent/folder/x.png"}, 3, "/nonexistent/folder/x.png");
  expect_failure({"stream", "/nonexistent/mesh.off", "-o", sphere_ + "/frames"}, 3, "frames");
}

TEST_F(CliTest, AServerThatIsNotThereIsStatus4) {
  expect_failure({"info", sphere_, "--server", "127.0.0.1:1"}, 4, "127.0.0.1:1");
}

TEST_F(CliTest, CtrlCEndsPreprocessing) {
  const std::string big = write_sphere("big.off", 400);
  Process process({"preprocess", big, "-n", "4000000"});
  ASSERT_TRUE(process.wait_for("big.off: ")) << process.err();  // the first line of progress
  process.signal(SIGINT);
  const Finished finished = process.finish();
  EXPECT_EQ(finished.status, 130) << finished.err;
  EXPECT_THAT(finished.err, HasSubstr("curvecast: interrupted"));
  EXPECT_THAT(finished.out, IsEmpty());
}

}  // namespace
}  // namespace curvecast::cli
