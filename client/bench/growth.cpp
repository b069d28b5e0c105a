#include "client/bench/growth.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <cmath>
#include <optional>
#include <utility>

#include "client/bench/peak_memory.h"
#include "client/bench/peers/simplification_chain.h"
#include "client/bench/stages.h"
#include "client/bench/subdivide.h"
#include "core/base/stopwatch.h"

namespace curvecast::cli::bench {
namespace {

constexpr int kMaxLevels = 6;
constexpr std::uint64_t kMaxFaces = std::uint64_t{1} << 30;

/// Stages that every size goes through.
bool is_common(const Stage& stage) { return stage.seconds != &StageSeconds::read && stage.seconds != &StageSeconds::repair; }

struct Size {
  double faces = 0;
  StageSeconds seconds;
  std::uint64_t peak_bytes = 0;
  double chain_seconds = 0;
};

LoadedMesh refine(const LoadedMesh& coarse) {
  LoadedMesh fine{.mesh = subdivide(coarse.mesh), .attributes = {}, .sources = {}, .info = coarse.info};
  fine.info.vertices = fine.mesh.vertex_count();
  fine.info.faces = fine.mesh.face_count();
  fine.info.area = surface_area(fine.mesh);
  fine.info.box = bounding_box(fine.mesh);
  return fine;
}

void add_size(const Size& size, const std::optional<Size>& before, BenchReport& report) {
  const std::string faces = absl::StrFormat("%.0f faces: ", size.faces);
  for (const Stage& stage : kStages) {
    if (!is_common(stage)) continue;
    BenchResult& result = report.results.emplace_back(BenchResult{faces + stage.name, size.seconds.*stage.seconds, "s"});
    if (stage.seconds == &StageSeconds::total) result.reference = size.chain_seconds;
  }
  if (size.peak_bytes > 0) {
    report.results.push_back({faces + "peak memory", static_cast<double>(size.peak_bytes) / size.faces, "bytes/face"});
  }
  if (!before) return;
  for (const Stage& stage : kStages) {
    const double ratio = size.seconds.*stage.seconds / before->seconds.*stage.seconds;
    if (is_common(stage)) {
      report.results.push_back(
          {faces + stage.name + " exponent", std::log(ratio) / std::log(size.faces / before->faces), "power"});
    }
  }
}

}  // namespace

absl::StatusOr<BenchReport> bench_growth(const MeshFile& file, const GrowthOptions& options, const ExecutionContext& context) {
  if (options.levels < 1 || options.levels > kMaxLevels) {
    return absl::InvalidArgumentError(absl::StrFormat("levels = %d; it must lie in 1 .. %d", options.levels, kMaxLevels));
  }
  const PreprocessOptions preprocess_options{.points = options.points};
  BenchReport report{"growth", {}};
  std::optional<Size> before;
  LoadedMesh loaded;  // the next size
  bool counts_memory = true;
  for (int level = 0; level <= options.levels; ++level) {
    counts_memory = reset_peak_memory() && counts_memory;
    absl::StatusOr<FlattenedMesh> flattened = level == 0 ? flatten_mesh(file, preprocess_options, context)
                                                         : flatten_mesh(std::move(loaded), preprocess_options, context);
    if (!flattened.ok()) return flattened.status();
    const auto shared = std::make_shared<const FlattenedMesh>(*std::move(flattened));
    absl::StatusOr<Preprocessed> done = lay_curve(shared, preprocess_options, context);
    if (!done.ok()) return done.status();
    Size size{static_cast<double>(done->report.mesh.faces), done->report.seconds, counts_memory ? peak_memory() : 0};
    size.seconds.total -= size.seconds.read + size.seconds.repair;
    done = absl::UnknownError("freed");
    if (absl::Status status = context.check(); !status.ok()) return status;
    context.progress("chain of levels", 0);
    Stopwatch watch;
    simplification_chain(shared->loaded.mesh);
    size.chain_seconds = watch.lap();
    add_size(size, before, report);
    before = size;
    if (level == options.levels) break;
    if (4 * shared->loaded.info.faces > kMaxFaces) {
      return absl::InvalidArgumentError(absl::StrCat("level ", level + 1, " would have more than ", kMaxFaces, " faces"));
    }
    loaded = refine(shared->loaded);
  }
  report.notes = {
      absl::StrFormat("%s and %d subdivisions, one run each, for %d points; total is without reading and repair.", file.name,
                      options.levels, options.points),
      "The reference of a total is what others would make instead: a chain of levels of detail by meshoptimizer, each "
      "with half of the triangles of the one before, down to 1,000, on one thread.",
      "Each triangle becomes four; the edges' middles lie on a curved surface (PN triangles), not on the flat faces.",
      counts_memory ? "Peak memory is VmHWM of this process, reset before each size: mesh, work and curve together."
                    : "Peak memory is not measured: this system does not let a process reset VmHWM."};
  return report;
}

}  // namespace curvecast::cli::bench
