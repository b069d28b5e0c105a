// Kills real processes that share a list, starts them again, and looks at what they have made.
#include <absl/strings/str_cat.h>
#include <signal.h>

#include <fstream>
#include <map>
#include <memory>

#include "core/storage/atomic_file.h"
#include "tests/client/cli_fixture.h"

namespace curvecast::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kShards = 4, kMeshes = 8, kEntries = 3 * kMeshes;

class BatchKillTest : public CliTest {
 protected:
  static std::vector<std::string> command(const std::string& manifest, const std::string& out, int shard, int shards) {
    return {"batch", manifest, "--out", out, "-n", "3000", "--max-points", "3000", "--shard", absl::StrCat(shard, "/", shards)};
  }

  /// Spheres of several sizes, each three times: even, in two formats, and with a density that has the curve refined.
  static std::string write_list() {
    const std::string list = temporary("kill.jsonl");
    std::ofstream out(list);
    for (int i = 0; i < kMeshes; ++i) {
      const std::string mesh = fs::path(write_sphere(absl::StrCat("kill_", i, ".off"), 20 + 3 * i)).filename().string();
      out << mesh << '\n'
          << json({{"mesh", mesh}, {"name", absl::StrCat("steep/", i)}, {"density", "expression:1 + 400 * (z > 0.9)"}}) << '\n'
          << json({{"mesh", mesh}, {"name", absl::StrCat("ranked/", i)}, {"sampler", "progressive"}, {"format", "drc"}}) << '\n';
    }
    return list;
  }

  static std::string output_name(int entry) {
    const int mesh = entry / 3;
    return entry % 3 == 0   ? absl::StrCat("kill_", mesh, ".ply")
           : entry % 3 == 1 ? absl::StrCat("steep/", mesh, ".ply")
                            : absl::StrCat("ranked/", mesh, ".drc");
  }
  static std::string index_path(const std::string& folder, int shard) {
    return absl::StrCat(folder, "/index-", shard, "-of-", kShards, ".jsonl");
  }

  /// What was made, by name, without records and indices, which tell the time.
  static std::map<std::string, std::string> outputs(const std::string& folder) {
    std::map<std::string, std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      const std::string name = fs::relative(entry.path(), folder).string(), ending = entry.path().extension().string();
      EXPECT_FALSE(is_temporary(name)) << name;
      if (entry.is_regular_file() && ending != ".json" && ending != ".jsonl") found[name] = bytes_of(entry.path().string());
    }
    return found;
  }

  /// As if a shard had never been worked on.
  static void forget(const std::string& folder, int shard) {
    for (int entry = shard; entry < kEntries; entry += kShards) {
      fs::remove(folder + "/" + output_name(entry));
      fs::remove(folder + "/" + output_name(entry) + ".json");
    }
    fs::remove(index_path(folder, shard));
  }

  /// Ends a process in the midst of its work: what it says on standard error shows that it has made one mesh at least.
  static bool is_killed_midway(const std::vector<std::string>& arguments) {
    Process process(arguments);
    EXPECT_TRUE(process.wait_for("] ")) << process.err();
    process.signal(SIGKILL);
    return process.finish().status == 128 + SIGKILL;
  }

  /// Runs all shards at once to their ends.
  static void finish_all(const std::string& list, const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::unique_ptr<Process>> processes;
    for (int shard = 0; shard < kShards; ++shard) {
      std::vector<std::string> arguments = command(list, out, shard, kShards);
      arguments.insert(arguments.end(), more.begin(), more.end());
      processes.push_back(std::make_unique<Process>(arguments));
    }
    for (const auto& process : processes) {
      const Finished finished = process->finish();
      EXPECT_EQ(finished.status, 0) << finished.err;
    }
  }
};

TEST_F(BatchKillTest, FourProcessesOfWhichTwoAreKilledMakeWhatOneMakes) {
  const std::string list = write_list(), one = temporary("one"), four = temporary("four");
  const Finished whole = run(command(list, one, 0, 1));
  ASSERT_EQ(whole.status, 0) << whole.err;
  const auto wanted = outputs(one);
  ASSERT_EQ(wanted.size(), std::size_t{kEntries});

  std::vector<std::unique_ptr<Process>> left_alone;
  for (const int shard : {0, 2}) left_alone.push_back(std::make_unique<Process>(command(list, four, shard, kShards)));
  for (const int shard : {1, 3}) {
    // One that was done before the signal came shows nothing.
    while (!is_killed_midway(command(list, four, shard, kShards))) forget(four, shard);
    EXPECT_FALSE(fs::exists(index_path(four, shard))) << "it stands for what is whole";
  }
  for (const auto& process : left_alone) EXPECT_EQ(process->finish().status, 0);
  const json kept = run_json(command(list, four, 1, kShards));
  EXPECT_GE(kept["kept"], 1) << "what was done before the kill is not done again";
  EXPECT_EQ(kept["kept"].get<int>() + kept["made"].get<int>(), kEntries / kShards);
  finish_all(list, four, {});
  EXPECT_TRUE(outputs(four) == wanted) << "the same names and bytes";
  for (int shard = 0; shard < kShards; ++shard) EXPECT_TRUE(fs::exists(index_path(four, shard)));
}

TEST_F(BatchKillTest, ASharedCacheChangesNoPoints) {
  const std::string list = write_list(), one = temporary("alone"), four = temporary("shared"), cache = temporary("shared_cache");
  ASSERT_EQ(run(command(list, one, 0, 1)).status, 0);
  std::vector<std::string> killed = command(list, four, 1, kShards);
  killed.insert(killed.end(), {"--cache", cache});
  is_killed_midway(killed);
  finish_all(list, four, {"--cache", cache});
  EXPECT_TRUE(outputs(four) == outputs(one)) << "though curves there were refined for other points";
  // Once more, from a cache where curves are refined.
  fs::remove_all(four);
  finish_all(list, four, {"--cache", cache});
  EXPECT_TRUE(outputs(four) == outputs(one));
}

}  // namespace
}  // namespace curvecast::cli
