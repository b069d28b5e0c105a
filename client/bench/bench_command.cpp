#include "client/bench/bench_command.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <CLI/CLI.hpp>

#include <atomic>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <utility>

#include "client/bench/areas.h"
#include "client/bench/corpus.h"
#include "client/bench/corpus_table.h"
#include "client/bench/curve_bench.h"
#include "client/bench/discrepancy_bench.h"
#include "client/bench/growth.h"
#include "client/bench/local_mesh.h"
#include "client/bench/mappers.h"
#include "client/bench/paper/paper_bench.h"
#include "client/bench/paper/paper_files.h"
#include "client/bench/paper/paper_json.h"
#include "client/bench/picture_bench.h"
#include "client/bench/preprocess_bench.h"
#include "client/bench/remesh_bench.h"
#include "client/bench/sample_bench.h"
#include "client/bench/stream_bench.h"
#include "client/bench/zoom_bench.h"
#include "client/cli/progress_bar.h"
#include "client/lib/file_bytes.h"
#include "core/base/spill.h"
#include "server/base/scratch_folder.h"

namespace curvecast::cli::bench {
namespace {

/// What a benchmark does once its flags are parsed.
using Run = std::function<absl::Status(const CommonOptions& common, ExecutionContext context, const std::stop_token& stop)>;

struct Benchmark {
  const char* name;
  const char* operand;
  const char* summary;        // a line of --list
  const char* description;    // of its --help
  Run (*add)(CLI::App& app);  // adds what it takes
};

absl::Status print_report(const BenchReport& report, const CommonOptions& common) {
  return common.json ? print_json(bench_json(report)) : print_text(bench_text(report));
}

CLI::Option* add_points(CLI::App& app, std::uint64_t* points, const std::string& description = "N for which the curve is made") {
  return app.add_option("-n,--points", *points, description)->check(point_count_range())->type_name("N")->capture_default_str();
}

CLI::Option* add_count(CLI::App& app, const std::string& name, int* count, int most, const std::string& description) {
  const std::string letter(1, static_cast<char>(name[2] - 'a' + 'A'));
  return app.add_option(name, *count, description)->check(CLI::Range(1, most))->type_name(letter)->capture_default_str();
}

/// What benchmarks of preprocessing take that tell a median.
template <typename Options>
void add_repeats_and_points(CLI::App& app, Options& options, const std::string& repeats) {
  add_count(app, "--repeat", &options.repeats, 1000, repeats);
  add_points(app, &options.points);
}

struct CorpusFlags {
  std::string folder, out;
  CorpusOptions corpus;
};

absl::Status run_corpus_bench(const CorpusFlags& flags, const CommonOptions& common, const ExecutionContext& context) {
  if (!flags.out.empty()) {
    if (absl::Status status = client::check_writable(flags.out); !status.ok()) return status;
  }
  std::size_t done = 0;
  const auto on_entry = [&](const CorpusEntry& entry) {
    ++done;
    if (common.quiet) return;
    constexpr const char* kWords[] = {"passed", "FAILED", "REFUSED", "nothing to sample"};
    std::fprintf(stderr, "%4zu %s: %s in %.2f s %s\n", done, entry.name.c_str(), kWords[static_cast<int>(entry.verdict)],
                 entry.seconds, entry.message.c_str());
  };
  CorpusOptions corpus = flags.corpus;
  corpus.seed = common.seed;
  const absl::StatusOr<std::vector<CorpusEntry>> entries = run_corpus(flags.folder, corpus, context, on_entry);
  if (!entries.ok()) return entries.status();
  if (!flags.out.empty()) {
    const bool csv = std::filesystem::path(flags.out).extension() == ".csv";
    const std::string table = csv ? corpus_csv(*entries) : corpus_markdown(*entries);
    if (absl::Status status = client::write_bytes(flags.out, table); !status.ok()) return status;
  }
  absl::Status printed = common.json         ? print_json(corpus_json(*entries))
                         : flags.out.empty() ? print_text(corpus_markdown(*entries))
                                             : print_text(bench_text(summarise_corpus(*entries)));
  if (!printed.ok()) return printed;
  if (!corpus_passed(*entries)) return absl::FailedPreconditionError("not every mesh of the folder came through as it should");
  return absl::OkStatus();
}

Run add_corpus(CLI::App& app) {
  const auto flags = std::make_shared<CorpusFlags>();
  app.add_option("DIR", flags->folder, "the folder")->required();
  app.add_option("--out", flags->out, "a line for each file: .md or .csv")
      ->check(validator(
          [](const std::string& path) {
            return check_ending(path, {".md", ".csv"});
          },
          ""))
      ->type_name("FILE");
  add_points(app, &flags->corpus.points, "points of the sample, and N of the curve");
  return [flags](const CommonOptions& common, const ExecutionContext& context, const std::stop_token&) {
    return run_corpus_bench(*flags, common, context);
  };
}

template <typename Options>
using Measure = absl::StatusOr<BenchReport> (*)(const MeshFile& file, const Options& options, const ExecutionContext& context);

/// A benchmark of one mesh: adds MESH; reads it and hands it to `measure`.
template <typename Options>
Run on_mesh(CLI::App& app, std::shared_ptr<Options> options, Measure<Options> measure) {
  const auto path = std::make_shared<std::string>();
  app.add_option("MESH", *path, kMeshHelp)->required();
  return [path, options, measure](const CommonOptions& common, ExecutionContext context, const std::stop_token&) {
    absl::StatusOr<LocalMesh> mesh = LocalMesh::read(*path);
    if (!mesh.ok()) return mesh.status();
    const std::string name = std::filesystem::path(*path).filename().string();
    ProgressBar bar(progress_style(common.quiet), name);
    context.on_progress = [&](std::string_view stage, double fraction) { bar.update(stage, fraction); };
    if constexpr (requires { options->seed; }) options->seed = common.seed;
    const absl::StatusOr<BenchReport> report = measure(mesh->file(name), *options, context);
    bar.finish();
    return report.ok() ? print_report(*report, common) : report.status();
  };
}

Run add_preprocess_benchmark(CLI::App& app) {
  const auto options = std::make_shared<PreprocessBenchOptions>();
  add_repeats_and_points(app, *options, "runs of ours, of which the median counts");
  return on_mesh(app, options, bench_preprocess);
}

Run add_curve(CLI::App& app) {
  const auto options = std::make_shared<CurveBenchOptions>();
  add_repeats_and_points(app, *options, "runs of which the median counts");
  app.add_option("--large", options->large_points, "N of one large run; 0 = none")
      ->check(CLI::Range(std::uint64_t{0}, kMaxPoints))
      ->type_name("N")
      ->capture_default_str();
  return on_mesh(app, options, bench_curve);
}

Run add_growth(CLI::App& app) {
  const auto options = std::make_shared<GrowthOptions>();
  add_count(app, "--levels", &options->levels, 6, "subdivisions");
  add_points(app, &options->points);
  return on_mesh(app, options, bench_growth);
}

Run add_mappers(CLI::App& app) {
  const auto options = std::make_shared<MappersBenchOptions>();
  add_repeats_and_points(app, *options, "runs of each, of which the median counts");
  return on_mesh(app, options, bench_mappers);
}

Run add_areas(CLI::App& app) {
  const auto options = std::make_shared<AreasBenchOptions>();
  add_count(app, "--runs", &options->runs, 1000, "sets of samples of each size");
  add_count(app, "--regions", &options->regions, 100'000, "seeds of the regions that discrepancy is measured over");
  add_points(app, &options->points);
  return on_mesh(app, options, bench_areas);
}

Run add_sample_benchmark(CLI::App& app) {
  const auto options = std::make_shared<SampleBenchOptions>();
  add_count(app, "--repeat", &options->repeats, 10'000, "rounds of which the median counts");
  add_points(app, &options->points, "N for which the curve is made, and of the point sets without a view");
  app.add_option("--view-points", options->view_points, "points under a view")
      ->check(point_count_range())
      ->type_name("N")
      ->capture_default_str();
  return on_mesh(app, options, bench_sample);
}

Run add_discrepancy(CLI::App& app) {
  const auto options = std::make_shared<DiscrepancyBenchOptions>();
  add_points(app, &options->points, "the largest set, and N for which the curve is made");
  app.add_option("--chart-faces", options->chart_faces,
                 "divide the mesh into charts of about so many faces; 0 = only very large meshes")
      ->type_name("F")
      ->capture_default_str();
  app.add_option("--ring-points", options->ring_points,
                 "N of the paper's test over rings, on a curve for so many points; 0 = none; the paper's: 1,600,000")
      ->check(CLI::Range(std::uint64_t{0}, kMaxPoints))
      ->type_name("N")
      ->capture_default_str();
  app.add_flag("--curvature", options->curvature, "rings with a density by curvature, and weighted with it");
  app.add_option("--formula", options->formula,
                 "rings with a density by a formula as in --density expression:FORMULA, and weighted with it; times --curvature");
  return on_mesh(app, options, bench_discrepancy);
}

Run add_remesh_benchmark(CLI::App& app) {
  const auto options = std::make_shared<RemeshBenchOptions>();
  app.add_option("-n,--vertices", options->vertices, "vertices of the new meshes; 0 = 75, 50 and 25 % of the mesh's own")
      ->check(CLI::Range(std::uint64_t{0}, kMaxPoints))
      ->type_name("N")
      ->capture_default_str();
  add_count(app, "--repeat", &options->repeats, 1000, "runs of ours, of which the fastest counts");
  app.add_flag("--peers,!--no-peers", options->peers, "CGAL and meshoptimizer beside ours")->capture_default_str();
  return on_mesh(app, options, bench_remesh);
}

Run add_stream_benchmark(CLI::App& app) {
  const auto options = std::make_shared<StreamBenchOptions>();
  add_points(app, &options->points, "points of a client alone, and N for which the curve is made");
  app.add_option("--crowd-points", options->crowd_points, "points of each of many clients")
      ->check(point_count_range())
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--clients", options->clients, "the largest crowd")->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_option("--seconds", options->seconds, "for each crowd")->check(CLI::Range(0.1, 3600.0))->capture_default_str();
  app.add_option("--rate", options->rate, "views of each client per second")->check(CLI::Range(0.1, 1e4))->capture_default_str();
  app.add_flag("--abuse,!--no-abuse", options->abuse, "a crowd beside clients that behave badly too")->capture_default_str();
  app.add_option("--idle", options->idle,
                 "clients of which the memory is measured that they take while they do nothing; 0 = none")
      ->check(CLI::Range(0, 10'000))
      ->capture_default_str();
  return on_mesh(app, options, bench_stream);
}

Run add_zoom(CLI::App& app) {
  const auto options = std::make_shared<ZoomBenchOptions>();
  app.add_option("-n,--points", options->points, "points of the views: a path for each number")
      ->check(point_count_range())
      ->type_name("N")
      ->capture_default_str();
  add_count(app, "--frames", &options->frames, 100'000, "views of the path, down and up together");
  add_count(app, "--stops", &options->stops, 1000, "on the way down, and again on the way up");
  app.add_option("--rate", options->rate, "views per second")->check(CLI::Range(0.1, 1e4))->capture_default_str();
  app.add_option("--nearest", options->nearest, "distance from the surface at the nearest stop, in diagonals of the mesh's box")
      ->check(CLI::Range(1e-6, 1.0))
      ->capture_default_str();
  add_count(app, "--width", &options->width, 4096, "of the camera's picture, pixels");
  add_count(app, "--height", &options->height, 4096, "of the camera's picture, pixels");
  app.add_option("--wander", options->wander,
                 "views of random places from near by after the path, and the memory of the server after them; 0 = none")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app.add_option(
         "--pictures", options->pictures,
         "a folder for a picture of each stop, the points beside the mesh itself; made if missing. The table then has the "
         "coverage, which takes time")
      ->type_name("DIR");
  return on_mesh(app, options, bench_zoom);
}

Run add_picture(CLI::App& app) {
  const auto options = std::make_shared<PictureBenchOptions>();
  app.add_option("-n,--points", options->points, "points of the views: a path for each number")
      ->check(point_count_range())
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--distances", options->distances, "of the stops from the surface, in diagonals of the mesh's box; each nearer")
      ->check(CLI::Range(1e-6, 100.0))
      ->type_name("D")
      ->capture_default_str();
  add_count(app, "--steps", &options->steps, 1000, "views from one stop to the next");
  app.add_option("--density", options->density, "factors of the views' density, as `curvecast sample --help` explains them")
      ->type_name("TERM")
      ->capture_default_str();
  app.add_option("--size", options->size, "of the picture's sides, pixels")
      ->check(CLI::Range(16, 4096))
      ->type_name("P")
      ->capture_default_str();
  app.add_option(
         "--pictures", options->pictures,
         "a folder for a picture of each stop (the mesh, its points, the simplified mesh, even points) and for charts; made "
         "if missing")
      ->type_name("DIR");
  return on_mesh(app, options, bench_picture);
}

struct PaperFlags {
  std::vector<std::string> meshes;
  std::string out = "paper";
  PaperBenchOptions paper;
};

absl::Status run_paper_bench(const PaperFlags& flags, const CommonOptions& common, ExecutionContext context,
                             const std::stop_token& stop) {
  if (absl::Status status = prepare_paper_folder(flags.out); !status.ok()) return status;
  std::deque<LocalMesh> meshes;
  std::deque<std::string> names;
  std::vector<PaperInput> inputs;
  for (const std::string& path : flags.meshes) {
    absl::StatusOr<LocalMesh> mesh = LocalMesh::read(path);
    if (!mesh.ok()) return mesh.status();
    names.push_back(std::filesystem::path(path).filename().string());
    inputs.push_back({path, meshes.emplace_back(*std::move(mesh)).file(names.back())});
  }
  ProgressBar bar(progress_style(common.quiet), "paper");
  context.on_progress = [&](std::string_view stage, double fraction) { bar.update(stage, fraction); };
  PaperBenchOptions options = flags.paper;
  options.machine = machine_name();
  const absl::StatusOr<PaperFindings> findings = bench_paper(inputs, options, common, context, stop);
  bar.finish();
  if (!findings.ok()) return findings.status();
  if (absl::Status status = write_paper_files(flags.out, *findings); !status.ok()) return status;
  return common.json ? print_json(paper_json(*findings)) : print_text(paper_summary(flags.out, *findings));
}

Run add_paper(CLI::App& app) {
  const auto flags = std::make_shared<PaperFlags>();
  app.add_option("MESH", flags->meshes,
                 "meshes; the paper's own numbers stand beside those with igea, squirrel, lion or caesar in their names");
  app.add_option("--out", flags->out, "the folder for paper.html and paper.json; made if missing")
      ->type_name("DIR")
      ->capture_default_str();
  app.add_flag("--quick", flags->paper.quick, "far fewer points, small pictures: seconds instead of minutes");
  return [flags](const CommonOptions& common, const ExecutionContext& context, const std::stop_token& stop) {
    return run_paper_bench(*flags, common, context, stop);
  };
}

constexpr Benchmark kBenchmarks[] = {
    {"paper", "[MESH...]", "every table and figure of the paper on one page, ours beside its numbers",
     "Measures and draws tables 1 and 2 and figures 1 to 9 of the paper, ours as it comes and with the paper's own ways, beside "
     "the paper's numbers, and writes them as one page that needs nothing else, with a JSON file of the numbers beside it. Takes "
     "about three minutes for each mesh of the paper; without a mesh it has what needs none.",
     add_paper},
    {"corpus", "DIR", "every mesh of a folder through all of preprocessing, checked",
     "Takes every .ply, .obj, .off, .stl, .gltf, .glb and .3mf file below a folder through all of preprocessing and a uniform "
     "sample. "
     "Ends with status 0 only if every file that holds a triangle with an area came through: no flipped triangle, the whole area "
     "(1e-9), every sample on its face. What fails does not stop the others.",
     add_corpus},
    {"preprocess", "MESH", "seconds of each stage, beside CGAL's parameteriser",
     "Seconds of every stage, with one thread and with all cores, beside CGAL's parameteriser on the same discs in the same run.",
     add_preprocess_benchmark},
    {"curve", "MESH", "seconds to lay the curve: quadtree, map, area elements",
     "Seconds to lay the curve with one thread and with all cores, beside the time that it takes to write its bytes; then once "
     "for "
     "many more points, with the memory that it takes.",
     add_curve},
    {"growth", "MESH", "time and memory against the number of faces",
     "Seconds and peak memory for a mesh and its subdivisions, each with four times the faces, the exponent with which the "
     "seconds grow, and a chain of levels of detail by meshoptimizer beside them.",
     add_growth},
    {"mappers", "MESH", "the exact mapper beside the one that draws the parameter mesh",
     "Seconds of the exact mapper and of the ID buffer on the same leaves, and the shares of centres for which they differ and "
     "for "
     "which the picture alone would not do.",
     add_mappers},
    {"areas", "MESH", "exact area elements beside Voronoi areas",
     "Seconds of both area elements, how far their sums miss the surface's area, and the ring discrepancy of jittered samples "
     "drawn with each, beside random ones.",
     add_areas},
    {"sample", "MESH", "milliseconds of a new N and of a new view, stage by stage",
     "Milliseconds to change the number of points, evenly and with curvature's density, and to change the view, stage by stage, "
     "beside the time to read the curve's positions, normals and areas once.",
     add_sample_benchmark},
    {"discrepancy", "MESH", "how evenly each sampler and sequence spreads points",
     "Discrepancy over balls beside random points, relative radius and coverage radius of every sampler and sequence, of random "
     "points, also triangle by triangle, of farthest-point order and of sample elimination, for powers of four and numbers "
     "between; and the power of N by which the discrepancy over rings falls.",
     add_discrepancy},
    {"remesh", "MESH", "meshes made of points beside those of CGAL and meshoptimizer",
     "Seconds, distance from the surface (as Metro measures it), angles and topology of meshes made of points, with every usual "
     "density, relaxed and fitted, beside CGAL's isotropic remeshing and edge collapses and meshoptimizer's, at equal numbers of "
     "vertices.",
     add_remesh_benchmark},
    {"stream", "MESH", "latency, bytes and processor time of views, of one client and of many",
     "Milliseconds from sending a view until its points are decoded, over TCP on the loopback: of one client with key frames and "
     "with deltas, and of crowds of 1, 8, 64 ... clients that send views at a fixed rate; bytes of their frames, and processor "
     "time.",
     add_stream_benchmark},
    {"zoom", "MESH", "points, bytes, latency and memory on the way down to the surface and back",
     "One client goes from the whole mesh down to a place of its surface and back up, over TCP on the loopback, and waits at "
     "stops "
     "until nothing better follows: points, of how many, what limits them, the time to the last frame, bytes and ranks of each "
     "stop; latency of deltas in motion, processor time of a frame, memory of the server.",
     add_zoom},
    {"picture", "MESH", "the picture that bytes give: of points, of a simplified mesh, of even points",
     "One client comes from where the whole mesh is seen down to its surface. At each stop the picture of its points is held "
     "against "
     "one of the mesh itself, beside those of what as many bytes bring otherwise: the mesh simplified by meshoptimizer and "
     "compressed "
     "by Draco; points spread evenly. FLIP, PSNR, SSIM, wrong pixels of the outline, holes.",
     add_picture},
};

std::string list_benchmarks() {
  std::string list;
  for (const Benchmark& benchmark : kBenchmarks) {
    absl::StrAppendFormat(&list, "%-18s%s\n", absl::StrCat(benchmark.name, " ", benchmark.operand), benchmark.summary);
  }
  return list;
}

absl::Status run(bool list, const Run& chosen, const CommonOptions& common, const std::stop_token& stop) {
  if (!common.server.empty()) {
    return absl::InvalidArgumentError("bench measures the work in this process: it takes no --server");
  }
  if (list) return print_text(list_benchmarks());
  std::atomic<bool> cancel = false;
  const std::stop_callback on_stop(stop, [&] { cancel = true; });
  ExecutionContext context;
  context.cancel = &cancel;
  context.threads = common.threads;
  if (common.memory > 0) {
    absl::Status status = keep_memory_within(common.memory, server::scratch_folder({}));
    if (!status.ok()) return status;
  }
  return chosen(common, context, stop);
}

}  // namespace

Command add_benchmarks(CLI::App& root, CommonOptions& options) {
  CLI::App* app = add_command(
      root, options, "bench",
      "Measures the work of a server in this process: preprocessing stage by stage, beside CGAL's "
      "parameteriser; a whole folder of meshes, checked; growth with the number of faces; the curve, the alternatives to "
      "its mapper and area elements, point sets.",
      {"curvecast bench --list", "curvecast bench preprocess igea.ply --repeat 5",
       "curvecast bench corpus meshes --out corpus.md", "curvecast bench paper igea.ply squirrel.obj --out paper",
       "curvecast bench growth igea.ply --json"});
  const auto list = std::make_shared<bool>(false);
  app->add_flag("--list", *list, "the benchmarks there are");
  const auto chosen = std::make_shared<Run>();
  for (const Benchmark& benchmark : kBenchmarks) {
    // The common options may stand after its own.
    CLI::App* const own = app->add_subcommand(benchmark.name, benchmark.description)->fallthrough();
    own->parse_complete_callback([chosen, run_it = benchmark.add(*own)] { *chosen = run_it; });
  }
  app->require_subcommand(0, 1);
  app->final_callback([list, app] {
    if (!*list && app->get_subcommands().empty()) {
      throw CLI::ValidationError("bench", "name a benchmark; --list tells which there are");
    }
  });
  return {app,
          [list, chosen](const CommonOptions& common, const std::stop_token& stop) { return run(*list, *chosen, common, stop); }};
}

}  // namespace curvecast::cli::bench
