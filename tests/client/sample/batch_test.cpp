// Runs `curvecast batch` on generated meshes.
#include <absl/strings/str_cat.h>
#include <signal.h>
#include <sys/stat.h>

#include <array>
#include <fstream>

#include "tests/client/cli_fixture.h"

namespace curvecast::cli {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class BatchTest : public CliTest {
 protected:
  void SetUp() override {
    out_ = temporary("out");
    for (const char* name : {"a.off", "b.off", "c.off"}) write_sphere(name, 8 + 2 * (name[0] - 'a'));
    write_list("a.off\nb.off\nc.off\n");
  }
  void TearDown() override {
    fs::remove_all(out_);
    for (const char* name : {"JOB_COMPLETION_INDEX", "SLURM_ARRAY_TASK_ID"}) ::unsetenv(name);
  }

  void write_list(const std::string& lines) {
    list_ = temporary("list.jsonl");
    std::ofstream(list_) << lines;
  }
  std::vector<std::string> batch(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"batch", list_, "--out", out_, "-n", "500", "--max-points", "500"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  /// As `batch -n 500`: made, kept, failed.
  void expect_tally(const std::vector<std::string>& more, int made, int kept) const {
    const json report = run_json(batch(more));
    EXPECT_EQ(report["made"], made) << report;
    EXPECT_EQ(report["kept"], kept) << report;
    EXPECT_EQ(report["failed"], 0) << report;
  }
  std::vector<json> index(const std::string& name = "index.jsonl") const {
    std::vector<json> lines;
    std::ifstream in(out_ + "/" + name);
    EXPECT_TRUE(in.is_open()) << name;
    for (std::string line; std::getline(in, line);) lines.push_back(json::parse(line));
    return lines;
  }
  std::string output(const std::string& name) const { return out_ + "/" + name; }

  std::string out_, list_;
};

TEST_F(BatchTest, MakesWhatSampleMakes) {
  write_list(
      R"json({"mesh": "a.off", "name": "sub/ranked", "sampler": "progressive", "attributes": ["rank", "surface"], "seed": 7})json"
      "\n"
      R"json({"mesh": "b.off", "format": "drc", "points": 700, "density": "view:s0=0.1", "camera": "eye=0,0,10", "position_bits": 12})json"
      "\n"
      R"json({"mesh": "c.off", "format": "xyz", "pixel_error": 40, "density": ["uniform", "expression:1 + 50 * (x > 0.8)"]})json"
      "\n");
  // As many as a session is made for by itself.
  const json report = run_json({"batch", list_, "--out", out_, "-n", "500"});
  EXPECT_EQ(report["made"], 3);
  const auto expect_same = [&](const std::string& mesh, std::vector<std::string> flags, const std::string& name) {
    const std::string path = temporary("sampled" + fs::path(name).extension().string());
    std::vector<std::string> arguments = {"sample", temporary(mesh), "-o", path, "--no-cache"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    const Finished sampled = run(arguments);
    ASSERT_EQ(sampled.status, 0) << sampled.err;
    EXPECT_TRUE(bytes_of(path) == bytes_of(output(name))) << name;
  };
  expect_same("a.off", {"-n", "500", "--sampler", "progressive", "--attributes", "rank,surface", "--seed", "7"},
              "sub/ranked.ply");
  expect_same("b.off", {"-n", "700", "--density", "view:s0=0.1", "--camera", "eye=0,0,10", "--position-bits", "12"}, "b.drc");
  expect_same("c.off", {"--pixel-error", "40", "--density", "uniform", "--density", "expression:1 + 50 * (x > 0.8)"}, "c.xyz");
}

TEST_F(BatchTest, TheIndexTellsOfEachMesh) {
  const Finished finished = run(batch());
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_THAT(finished.out, HasSubstr("3 made, 0 there already, 0 failed"));
  EXPECT_THAT(finished.err, HasSubstr("[2/3] b: 500 points"));
  const std::vector<json> lines = index();
  ASSERT_EQ(lines.size(), 3U);
  for (const json& line : lines) {
    expect_keys(line, {"mesh", "name", "sha256", "output", "points", "bytes", "seconds", "session_id"});
    EXPECT_FALSE(line.contains("settings"));
    EXPECT_FALSE(line.contains("error"));
    EXPECT_EQ(line["points"], 500);
    EXPECT_EQ(line["sha256"].get<std::string>().size(), 64U);
    EXPECT_EQ(line["bytes"], fs::file_size(output(line["output"])));
  }
  EXPECT_EQ(lines[1]["mesh"], "b.off");
  EXPECT_EQ(lines[1]["output"], "b.ply");
  EXPECT_EQ(json::parse(bytes_of(output("b.ply.json")))["sha256"], lines[1]["sha256"]);
  EXPECT_THAT(run(batch({"--quiet"})).err, IsEmpty());
  EXPECT_EQ(index(), lines) << "of what was there already too";
  struct stat info {};
  ASSERT_EQ(::stat(output("a.ply").c_str(), &info), 0);
  const mode_t mask = ::umask(0);
  ::umask(mask);
  EXPECT_EQ(info.st_mode & 0777, 0666 & ~mask) << "for whoever may read other files";
}

TEST_F(BatchTest, OnlyWhatIsMissingOrOtherIsMade) {
  expect_tally({}, 3, 0);
  expect_tally({}, 0, 3);
  expect_tally({"--shard", "1/2"}, 0, 1);
  fs::remove(output("a.ply"));
  expect_tally({}, 1, 2);
  fs::resize_file(output("b.ply"), 100);
  expect_tally({}, 1, 2);
  std::ofstream(output("c.ply.json")) << "{\"mesh\": ";
  expect_tally({}, 1, 2);
  write_sphere("b.off", 16);
  expect_tally({}, 1, 2);
  expect_tally({"--seed", "5"}, 3, 0);
  expect_tally({"--seed", "5", "--format", "drc"}, 3, 0);
  expect_tally({"--seed", "5"}, 0, 3);
  write_list("a.off\n{\"mesh\": \"b.off\", \"seed\": 6}\n");
  expect_tally({"--seed", "5"}, 1, 1);
}

TEST_F(BatchTest, WhatAMeshRefersToCountsToo) {
  fs::create_directories(temporary("obj"));
  std::ofstream(temporary("obj/square.mtl")) << "newmtl blue\nKd 0 0 1\n";
  std::ofstream(temporary("obj/square.obj"))
      << "mtllib square.mtl other.mtl\nusemtl blue\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
  write_list("obj/square.obj\n");
  expect_tally({}, 1, 0);
  expect_tally({}, 0, 1);
  std::ofstream(temporary("obj/square.mtl")) << "newmtl blue\nKd 1 0 0\n";
  expect_tally({}, 1, 0);
  std::ofstream(temporary("obj/other.mtl")) << "newmtl green\nKd 0 1 0\n";
  expect_tally({}, 1, 0);
  expect_tally({}, 0, 1);
  const auto points = load_points(output("obj/square.ply"));
  ASSERT_TRUE(points.ok()) << points.status();
  EXPECT_EQ(points->colours.front(), (std::array<std::uint8_t, 3>{255, 0, 0}));
}

TEST_F(BatchTest, ABadMeshDoesNotStopTheRest) {
  std::ofstream(temporary("broken.off")) << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n";
  write_list("a.off\nbroken.off\nmissing.off\nb.off\n");
  const Finished finished = run(batch({"--quiet"}));
  EXPECT_EQ(finished.status, 3);
  EXPECT_THAT(finished.out, HasSubstr("2 made, 0 there already, 2 failed"));
  EXPECT_THAT(finished.err, HasSubstr("curvecast: broken.off: "));
  EXPECT_THAT(finished.err, Not(HasSubstr("broken.off: broken.off")));
  EXPECT_THAT(finished.err, HasSubstr("curvecast: missing.off: cannot be opened"));
  EXPECT_THAT(finished.err, HasSubstr("2 of 4 meshes failed"));
  const std::vector<json> lines = index();
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_THAT(lines[1]["error"].get<std::string>(), HasSubstr("broken.off: "));
  EXPECT_FALSE(lines[1].contains("output"));
  EXPECT_EQ(lines[3]["points"], 500);
  EXPECT_FALSE(fs::exists(output("broken.ply.json"))) << "so that it is tried again";
  write_sphere("missing.off", 6);
  EXPECT_EQ(run(batch()).status, 3);
  EXPECT_FALSE(index()[2].contains("error"));
}

TEST_F(BatchTest, FailFastStopsAtTheFirst) {
  write_list("a.off\nnowhere.off\nb.off\n");
  const Finished finished = run(batch({"--fail-fast"}));
  EXPECT_EQ(finished.status, 3);
  EXPECT_THAT(finished.out, IsEmpty());
  EXPECT_THAT(finished.err, HasSubstr("curvecast: nowhere.off: cannot be opened"));
  EXPECT_THAT(finished.err, HasSubstr("1 of 3 meshes are done"));
  EXPECT_TRUE(fs::exists(output("a.ply")));
  EXPECT_FALSE(fs::exists(output("b.ply")));
  EXPECT_FALSE(fs::exists(output("index.jsonl")));
}

TEST_F(BatchTest, SessionsAreThereForServers) {
  const std::string cache = temporary("batch_cache");
  expect_tally({"--format", "none", "--cache", cache}, 3, 0);
  expect_tally({"--format", "none", "--cache", cache}, 0, 3);
  const json found = run_json({"preprocess", temporary("b.off"), "-n", "500", "--cache", cache});
  EXPECT_EQ(found["cached"], true);
  const std::vector<json> lines = index();
  EXPECT_EQ(lines[1]["session_id"], found["session_id"]);
  EXPECT_FALSE(lines[1].contains("output"));
  EXPECT_FALSE(fs::exists(output("b.ply")));
  expect_tally({"--cache", cache}, 3, 0);
  EXPECT_TRUE(fs::exists(output("b.ply")));
  fs::remove_all(cache);
  expect_tally({"--cache", cache}, 3, 0);
  expect_tally({}, 0, 3);
}

TEST_F(BatchTest, AServerIsAskedAsWell) {
  Process server({"serve", "--listen", "127.0.0.1:0", "--http", "none"});
  const std::string address = server.rest_of_line("listening on ");
  expect_tally({"--server", address}, 3, 0);
  const std::string there = bytes_of(output("b.ply"));
  fs::remove_all(out_);
  expect_tally({}, 3, 0);
  EXPECT_TRUE(bytes_of(output("b.ply")) == there);
  server.signal(SIGTERM);
  EXPECT_EQ(server.finish().status, 0);
  fs::remove_all(out_);
  const Finished alone = run(batch({"--server", address}));
  EXPECT_EQ(alone.status, 4) << "no mesh has a chance";
  EXPECT_THAT(alone.err, HasSubstr("0 of 3 meshes are done"));
}

TEST_F(BatchTest, ShardsComeFromTheEnvironment) {
  ASSERT_EQ(::setenv("JOB_COMPLETION_INDEX", "1", 1), 0);
  expect_tally({"--shard", "auto", "--shards", "2"}, 1, 0);
  EXPECT_EQ(index("index-1-of-2.jsonl").size(), 1U);
  EXPECT_TRUE(fs::exists(output("b.ply")));
  EXPECT_FALSE(fs::exists(output("a.ply")));
  ASSERT_EQ(::setenv("JOB_COMPLETION_INDEX", "11", 1), 0);
  expect_tally({"--shard", "auto", "--shards", "12"}, 0, 0);
  EXPECT_THAT(index("index-11-of-12.jsonl"), IsEmpty()) << "more shards than meshes";
  expect_failure(batch({"--shard", "auto"}), 3, "--shards");
}

TEST_F(BatchTest, TheScriptForSlurmRunsAShard) {
  const char* const variables[][2] = {{"CURVECAST", CURVECAST_COMMAND}, {"SLURM_ARRAY_TASK_ID", "0"},
                                      {"SLURM_ARRAY_TASK_MIN", "0"},    {"SLURM_ARRAY_TASK_MAX", "1"},
                                      {"SLURM_ARRAY_TASK_COUNT", "2"},  {"SLURM_CPUS_PER_TASK", "1"},
                                      {"SLURM_MEM_PER_NODE", "4096"}};
  for (const auto& [name, value] : variables) ASSERT_EQ(::setenv(name, value, 1), 0);
  const Finished finished =
      run({"bash", CURVECAST_SLURM_SCRIPT, list_, out_, "-n", "500", "--max-points", "500"}, "/usr/bin/env");
  ASSERT_EQ(::setenv("SHARDS", "3", 1), 0);
  const Finished third = run({"bash", CURVECAST_SLURM_SCRIPT, list_, out_, "-n", "500", "--max-points", "500"}, "/usr/bin/env");
  for (const auto& variable : variables) ::unsetenv(variable[0]);
  ::unsetenv("SHARDS");
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(index("index-0-of-2.jsonl").size(), 2U);
  EXPECT_EQ(third.status, 0) << third.err;
  EXPECT_EQ(index("index-0-of-3.jsonl").size(), 1U);
  EXPECT_EQ(run({"bash", CURVECAST_SLURM_SCRIPT, list_}, "/usr/bin/env").status, 2);
}

TEST_F(BatchTest, AnInterruptionKeepsWhatIsDone) {
  std::string lines;
  for (int i = 0; i < 200; ++i) lines += json({{"mesh", "c.off"}, {"name", std::to_string(i)}, {"seed", i}}).dump() + "\n";
  write_list(lines);
  Process process(batch());
  ASSERT_TRUE(process.wait_for("[1/200]")) << process.err();
  process.signal(SIGINT);
  const Finished finished = process.finish();
  EXPECT_EQ(finished.status, 130) << finished.err;
  EXPECT_THAT(finished.err, HasSubstr("meshes are done; the same command goes on there"));
  EXPECT_FALSE(fs::exists(output("index.jsonl")));
  std::size_t outputs = 0;
  for (const auto& entry : fs::directory_iterator(out_)) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() == ".ply") {
      ++outputs;
      EXPECT_TRUE(fs::exists(output(name + ".json")));
    } else {
      EXPECT_TRUE(name.ends_with(".ply.json")) << name << " is left over";
      EXPECT_TRUE(fs::exists(output(name.substr(0, name.size() - 5)))) << "a record of nothing";
    }
  }
  EXPECT_GE(outputs, 1U);
}

TEST_F(BatchTest, AMeshByWhichAProcessEndedComesLast) {
  fs::create_directories(out_);
  std::ofstream(output("a.ply.json")) << R"({"mesh": "a.off", "state": "making"})";
  const Finished finished = run(batch());
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_LT(finished.err.find("] c: "), finished.err.find("] a: "));
  EXPECT_EQ(index()[0]["mesh"], "a.off") << "the index is in the order of the list";
  expect_tally({}, 0, 3);
}

TEST_F(BatchTest, TheListMayComeFromStandardInput) {
  const std::string script =
      absl::StrCat("cd ", folder(), " && echo b.off | ", CURVECAST_COMMAND, " batch - --out ", out_, " -n 500 --max-points 500");
  const Finished finished = run({"bash", "-c", script}, "/usr/bin/env");
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_TRUE(fs::exists(output("b.ply")));
}

TEST_F(BatchTest, OutputsAreWrittenWhateverAKilledProcessLeft) {
  fs::create_directories(out_);
  std::ofstream(output("a.ply.curvecast-tmp")) << std::string(1 << 20, 'x');
  expect_tally({}, 3, 0);
  EXPECT_FALSE(fs::exists(output("a.ply.curvecast-tmp")));
  EXPECT_LT(fs::file_size(output("a.ply")), 1U << 20);
}

TEST_F(BatchTest, SaysWhatIsWrongBeforeItBegins) {
  expect_failure({"batch", list_}, 2, "--out");
  expect_failure({"batch", "--out", out_}, 2, "MANIFEST");
  for (const char* shard : {"2/2", "x", "1"}) expect_failure(batch({"--shard", shard}), 2, "shard");
  expect_failure(batch({"--format", "obj"}), 2, "there are: ply, xyz, pcd, drc, npy, npz, glb, spz, las, none");
  expect_failure(batch({"--cache", "x", "--server", "127.0.0.1:1"}), 2, "--server");
  expect_failure({"batch", list_, "--out", out_}, 3, "line 1: a.off: how many points?");
  expect_failure(batch({"--format", "none"}), 3, "--cache or --server");
  expect_failure({"batch", temporary("none.txt"), "--out", out_, "-n", "5"}, 3, "none.txt: cannot be opened");
  expect_failure({"batch", list_, "--out", sphere_, "-n", "5"}, 3, sphere_);
  expect_failure({"batch", list_, "--out", temporary("unused"), "-n", "5", "--cache", sphere_}, 3, "cache folder");
  write_list("a.off\n{\"mesh\": \"b.off\", \"pionts\": 5}\n");
  expect_failure(batch(), 3, "list.jsonl: line 2: b.off: there is no option 'pionts'");
  write_list("a.off\nx/../a.off\n");
  expect_failure(batch(), 3, "its output a.ply is that of line 1 too");
  EXPECT_FALSE(fs::exists(out_)) << "nothing was made";
}

}  // namespace
}  // namespace curvecast::cli
