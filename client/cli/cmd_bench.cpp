#include <atomic>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "client/cli/bench/corpus.h"
#include "client/cli/bench/corpus_table.h"
#include "client/cli/bench/curve_bench.h"
#include "client/cli/bench/growth.h"
#include "client/cli/bench/local_mesh.h"
#include "client/cli/bench/preprocess_bench.h"
#include "client/cli/commands.h"
#include "client/cli/progress_bar.h"
#include "client/lib/file_bytes.h"

namespace curvecast::cli {
namespace {

constexpr char kList[] =
    "corpus DIR        every mesh of a folder through all of preprocessing, checked\n"
    "curve MESH        seconds to lay the curve: quadtree, map, area elements\n"
    "preprocess MESH   seconds of each stage, beside CGAL's parameteriser\n"
    "growth MESH       time and memory against the number of faces\n";

struct Flags {
  bool list = false;
  std::string folder, out, curve_mesh, preprocess_mesh, growth_mesh;
  CorpusOptions corpus;
  CurveBenchOptions curve;
  PreprocessBenchOptions preprocess;
  GrowthOptions growth;
  CLI::App *corpus_app = nullptr, *curve_app = nullptr, *preprocess_app = nullptr, *growth_app = nullptr;
};

absl::Status print_report(const BenchReport& report, const CommonOptions& options) {
  return options.json ? print_json(bench_json(report)) : print_text(bench_text(report));
}

absl::Status run_corpus_bench(const Flags& flags, const CommonOptions& options, ExecutionContext context) {
  if (!flags.out.empty()) {
    if (absl::Status status = client::check_writable(flags.out); !status.ok()) return status;
  }
  std::size_t done = 0;
  const auto on_entry = [&](const CorpusEntry& entry) {
    ++done;
    if (options.quiet) return;
    constexpr const char* kWords[] = {"passed", "FAILED", "REFUSED", "nothing to sample"};
    std::fprintf(stderr, "%4zu %s: %s in %.2f s %s\n", done, entry.name.c_str(), kWords[static_cast<int>(entry.verdict)],
                 entry.seconds, entry.message.c_str());
  };
  CorpusOptions corpus = flags.corpus;
  corpus.seed = options.seed;
  context.on_progress = nullptr;
  const absl::StatusOr<std::vector<CorpusEntry>> entries = run_corpus(flags.folder, corpus, context, on_entry);
  if (!entries.ok()) return entries.status();
  if (!flags.out.empty()) {
    const bool csv = std::filesystem::path(flags.out).extension() == ".csv";
    const std::string table = csv ? corpus_csv(*entries) : corpus_markdown(*entries);
    if (absl::Status status = client::write_bytes(flags.out, table); !status.ok()) return status;
  }
  const absl::Status printed = options.json        ? print_json(corpus_json(*entries))
                               : flags.out.empty() ? print_text(corpus_markdown(*entries))
                                                   : print_text(bench_text(summarise_corpus(*entries)));
  if (!printed.ok()) return printed;
  if (!corpus_passed(*entries)) return absl::FailedPreconditionError("not every mesh of the folder came through as it should");
  return absl::OkStatus();
}

/// Reads the mesh and hands it to `measure`.
template <typename Measure>
absl::Status run_on_mesh(const std::string& path, const CommonOptions& options, ExecutionContext context, Measure&& measure) {
  absl::StatusOr<LocalMesh> mesh = LocalMesh::read(path);
  if (!mesh.ok()) return mesh.status();
  const std::string name = std::filesystem::path(path).filename().string();
  ProgressBar bar(progress_style(options.quiet), name);
  context.on_progress = [&](std::string_view stage, double fraction) { bar.update(stage, fraction); };
  const absl::StatusOr<BenchReport> report = measure(mesh->file(name), context);
  bar.finish();
  return report.ok() ? print_report(*report, options) : report.status();
}

absl::Status run(const Flags& flags, const CommonOptions& options, const std::stop_token& stop) {
  if (!options.server.empty()) {
    return absl::InvalidArgumentError("bench measures the work in this process: it takes no --server");
  }
  if (flags.list) return print_text(kList);
  std::atomic<bool> cancel = false;
  const std::stop_callback on_stop(stop, [&] { cancel = true; });
  ExecutionContext context;
  context.cancel = &cancel;
  context.threads = options.threads;
  if (flags.corpus_app->parsed()) return run_corpus_bench(flags, options, context);
  if (flags.curve_app->parsed()) {
    return run_on_mesh(flags.curve_mesh, options, context, [&](const MeshFile& file, const ExecutionContext& inner) {
      return bench_curve(file, flags.curve, inner);
    });
  }
  if (flags.preprocess_app->parsed()) {
    return run_on_mesh(flags.preprocess_mesh, options, context, [&](const MeshFile& file, const ExecutionContext& inner) {
      return bench_preprocess(file, flags.preprocess, inner);
    });
  }
  return run_on_mesh(flags.growth_mesh, options, context, [&](const MeshFile& file, const ExecutionContext& inner) {
    return bench_growth(file, flags.growth, inner);
  });
}

/// A benchmark; the common options may stand after its own.
CLI::App* add_benchmark(CLI::App* bench, const std::string& name, const std::string& description) {
  return bench->add_subcommand(name, description)->fallthrough();
}

CLI::Option* add_points(CLI::App* app, std::uint64_t* points, const std::string& description) {
  return app->add_option("-n,--points", *points, description)->check(point_count_range())->type_name("N")->capture_default_str();
}

}  // namespace

Command add_bench(CLI::App& root, CommonOptions& options) {
  CLI::App* app = add_command(root, options, "bench",
                              "Measures the work of a server in this process: preprocessing stage by stage, beside CGAL's "
                              "parameteriser; a whole folder of meshes, checked; growth with the number of faces.",
                              {"curvecast bench --list", "curvecast bench preprocess igea.ply --repeat 5",
                               "curvecast bench corpus meshes --out corpus.md", "curvecast bench growth igea.ply --json"});
  const auto flags = std::make_shared<Flags>();
  app->add_flag("--list", flags->list, "the benchmarks there are");

  flags->corpus_app = add_benchmark(
      app, "corpus",
      "Takes every .ply, .obj, .off, .stl, .gltf and .glb file below a folder through all of preprocessing and a uniform sample. "
      "Ends with "
      "status "
      "0 only if every file that holds a triangle with an area came through: no flipped triangle, the whole area (1e-9), every "
      "sample on its face. What fails does not stop the others.");
  flags->corpus_app->add_option("DIR", flags->folder, "the folder")->required();
  flags->corpus_app->add_option("--out", flags->out, "a line for each file: .md or .csv")
      ->check(validator(
          [](const std::string& path) {
            return check_ending(path, {".md", ".csv"});
          },
          ""))
      ->type_name("FILE");
  add_points(flags->corpus_app, &flags->corpus.points, "points of the sample, and N of the curve");

  flags->curve_app =
      add_benchmark(app, "curve",
                    "Seconds to lay the curve with one thread and with all cores, beside the time that it takes to "
                    "write its bytes; then once for many more points, with the memory that it takes.");
  flags->curve_app->add_option("MESH", flags->curve_mesh, "a .ply, .obj, .off, .stl, .gltf or .glb file")->required();
  flags->curve_app->add_option("--repeat", flags->curve.repeats, "runs, of which the median counts")
      ->check(CLI::Range(1, 1000))
      ->type_name("R")
      ->capture_default_str();
  add_points(flags->curve_app, &flags->curve.points, "N for which the curve is made");
  flags->curve_app->add_option("--large", flags->curve.large_points, "N of the one large run; 0 = none")
      ->check(CLI::Range(std::uint64_t{0}, kMaxPoints))
      ->type_name("N")
      ->capture_default_str();

  flags->preprocess_app = add_benchmark(app, "preprocess",
                                        "Seconds of every stage, with one thread and with all cores, beside CGAL's parameteriser "
                                        "on the same discs in the same run.");
  flags->preprocess_app->add_option("MESH", flags->preprocess_mesh, "a .ply, .obj, .off, .stl, .gltf or .glb file")->required();
  flags->preprocess_app->add_option("--repeat", flags->preprocess.repeats, "runs of ours, of which the median counts")
      ->check(CLI::Range(1, 1000))
      ->type_name("R")
      ->capture_default_str();
  add_points(flags->preprocess_app, &flags->preprocess.points, "N for which the curve is made");

  flags->growth_app =
      add_benchmark(app, "growth",
                    "Seconds and peak memory for a mesh and its subdivisions, each with four times the faces, and "
                    "the exponent with which the seconds grow.");
  flags->growth_app->add_option("MESH", flags->growth_mesh, "a .ply, .obj, .off, .stl, .gltf or .glb file")->required();
  flags->growth_app->add_option("--levels", flags->growth.levels, "subdivisions")
      ->check(CLI::Range(1, 6))
      ->type_name("L")
      ->capture_default_str();
  add_points(flags->growth_app, &flags->growth.points, "N for which the curve is made");
  app->require_subcommand(0, 1);
  app->final_callback([flags, app] {
    if (!flags->list && app->get_subcommands().empty()) {
      throw CLI::ValidationError("bench", "name a benchmark; --list tells which there are");
    }
  });
  return {app, [flags](const CommonOptions& common, std::stop_token stop) { return run(*flags, common, stop); }};
}

}  // namespace curvecast::cli
