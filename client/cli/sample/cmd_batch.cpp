#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <CLI/CLI.hpp>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include "client/cli/commands.h"
#include "client/cli/report.h"
#include "client/cli/sample/batch.h"
#include "client/cli/sample/batch_record.h"
#include "client/cli/sample/batch_settings.h"
#include "client/cli/sample/manifest.h"
#include "client/cli/sample/shard.h"
#include "client/lib/file_bytes.h"

namespace curvecast::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostShards = 1'000'000;

struct Flags {
  std::string manifest;
  std::string shard = "0/1";
  std::uint64_t shards = 0;
  BatchOptions batch;
  BatchSettings settings;
};

std::string variable(const std::string& name) {
  const char* const value = std::getenv(name.c_str());
  return value != nullptr ? value : "";
}

/// "index.jsonl", or "index-03-of-16.jsonl".
std::string index_name(const Shard& shard) {
  if (shard.count == 1) return "index.jsonl";
  const int digits = static_cast<int>(absl::StrCat(shard.count - 1).size());
  return absl::StrFormat("index-%0*d-of-%d.jsonl", digits, shard.index, shard.count);
}

absl::Status report(const CommonOptions& options, const BatchOptions& batch, const BatchTally& tally, const std::string& index,
                    double seconds) {
  if (options.json) {
    return print_json({{"meshes", tally.meshes},
                       {"made", tally.made},
                       {"kept", tally.kept},
                       {"failed", tally.failed},
                       {"points", tally.points},
                       {"seconds", seconds},
                       {"shard", {{"index", batch.shard.index}, {"count", batch.shard.count}}},
                       {"index", index}});
  }
  return print_text(
      absl::StrFormat("%d meshes      %d made, %d there already, %d failed\npoints         %d\nseconds        %.3f\n"
                      "written        %s\n",
                      tally.meshes, tally.made, tally.kept, tally.failed, tally.points, seconds, index));
}

absl::Status run(Flags& flags, const CommonOptions& options, const std::stop_token& stop) {
  const auto start = std::chrono::steady_clock::now();
  const absl::StatusOr<Shard> shard = parse_shard(flags.shard, flags.shards, variable);
  if (!shard.ok()) return shard.status();
  flags.batch.shard = *shard;
  flags.settings.seed = options.seed;
  if (!flags.settings.has_points() && options.cache.empty() && options.server.empty()) {
    return absl::InvalidArgumentError("--format none makes sessions only: say with --cache or --server where they shall be kept");
  }
  absl::StatusOr<std::vector<ManifestEntry>> entries = read_manifest(flags.manifest);
  if (!entries.ok()) return entries.status();
  EntryOptions entry_options(flags.settings);
  const std::string folder = flags.manifest == "-" ? "" : fs::path(flags.manifest).parent_path().string();
  const absl::StatusOr<std::vector<PlannedMesh>> plan = plan_batch(*std::move(entries), folder, flags.batch.out, entry_options);
  if (!plan.ok()) return absl::Status(plan.status().code(), absl::StrCat(flags.manifest, ": ", plan.status().message()));
  if (absl::Status status = make_folder(flags.batch.out); !status.ok()) return status;
  // There is an index where all meshes were gone through, and none before.
  const std::string index = (fs::path(flags.batch.out) / index_name(*shard)).string();
  std::error_code ignored;
  fs::remove(index, ignored);
  if (absl::Status status = client::check_writable(index); !status.ok()) return status;
  Batch batch(flags.batch, options, entry_options);
  const absl::Status ended = batch.run(*plan, stop);
  const BatchTally& tally = batch.tally();
  if (!ended.ok()) {
    if (!options.quiet) {
      print_note(absl::StrCat(tally.made + tally.kept, " of ", tally.meshes, " meshes are done; the same command goes on there"));
    }
    return ended;
  }
  if (absl::Status status = client::write_bytes(index, to_lines(batch.lines())); !status.ok()) return status;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (absl::Status status = report(options, flags.batch, tally, index, seconds); !status.ok()) return status;
  if (tally.failed == 0) return absl::OkStatus();
  return absl::Status(tally.worst, absl::StrCat(tally.failed, " of ", tally.meshes, " meshes failed; ", index, " says why"));
}

}  // namespace

Command add_batch(CLI::App& root, CommonOptions& options) {
  CLI::App* app = add_command(
      root, options, "batch",
      "Does to every mesh of a list what sample does to one: OUT/NAME.ply for each, and with --cache the prepared mesh too, for "
      "servers to come. A mesh that fails does not stop the rest. Killed at any moment, the same command goes on where it was: "
      "files are there whole or not at all, and what was made of the same bytes with the same options is left as it is. Several "
      "processes share a list by --shard; their points are the same to the bit as those of one.\n\n"
      "MANIFEST has a line for each mesh: its path, relative to the list's folder, or a JSON object with the path as \"mesh\", "
      "maybe "
      "a \"name\" for what is made of it (else its path without ending), and options for it alone, by their long names below: "
      "{\"mesh\": \"a/bunny.obj\", \"name\": \"rabbit\", \"points\": 20000, \"density\": [\"curvature\", \"view\"], \"seed\": "
      "7}. "
      "Lines that begin with # are left out.\n\n"
      "OUT/index.jsonl, of a shard OUT/index-I-of-N.jsonl, says at the end what became of each: an object in a line, with mesh, "
      "name, sha256 of the mesh, output, points, bytes, seconds, session_id, or error. OUT/NAME.ply.json says it of one, with "
      "all "
      "options.",
      {"curvecast batch meshes.txt --out points -n 50000",
       "find scans -name '*.ply' | curvecast batch - --out points -n 50000 --density curvature --format drc",
       "curvecast batch meshes.jsonl --out points -n 50000 --shard 0/4       # and 1/4, 2/4, 3/4, in other processes",
       "curvecast batch meshes.txt --out points -n 50000 --shard auto --shards 16    # in an indexed Job of Kubernetes",
       "curvecast batch meshes.txt --out made --format none --cache sessions   # then: curvecast serve --cache sessions"});
  const auto flags = std::make_shared<Flags>();
  app->add_option("MANIFEST", flags->manifest, "the list; -: standard input, with paths relative to the working folder")
      ->required();
  app->add_option("-o,--out", flags->batch.out, "folder of what is made; made if it is missing")->type_name("DIR")->required();
  app->add_option("--shard", flags->shard,
                  "I/N, I from 0 on: only each Nth mesh of the list, from the Ith on; or auto: I and N as the environment of "
                  "an indexed Job of Kubernetes ($JOB_COMPLETION_INDEX, with --shards) or of an array of Slurm says")
      ->check(validator(
          [](const std::string& text) { return text == kAuto ? absl::OkStatus() : parse_shard(text, 0, variable).status(); }, ""))
      ->type_name("I/N")
      ->capture_default_str();
  app->add_option("--shards", flags->shards, "N of --shard auto, which Slurm says itself for an array 0-(N-1)")
      ->check(CLI::Range(std::uint64_t{1}, kMostShards))
      ->type_name("N");
  app->add_flag("--fail-fast", flags->batch.fail_fast, "end with the first mesh that fails");
  app->add_option(
         "--cache", options.cache,
         "folder where prepared meshes are kept too, all of them, with copies of their files, as serve --cache and other "
         "commands find them")
      ->type_name("DIR")
      ->excludes(app->get_option("--server"));
  add_batch_settings(app, &flags->settings);
  return {app, [flags](const CommonOptions& common, std::stop_token stop) { return run(*flags, common, stop); }};
}

}  // namespace curvecast::cli
