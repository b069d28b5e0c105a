#include "client/bench/mappers.h"

#include <absl/strings/str_format.h>

#include <vector>

#include "client/bench/disc_leaves.h"
#include "client/bench/median.h"
#include "core/base/stopwatch.h"
#include "core/base/with_threads.h"
#include "core/curve/surface_map.h"
#include "core/reference/id_buffer.h"

namespace curvecast::cli::bench {
namespace {

absl::StatusOr<BenchReport> run(const MeshFile& file, const MappersBenchOptions& options, const ExecutionContext& context) {
  const absl::StatusOr<FlattenedMesh> flattened = flatten_mesh(file, {.points = options.points}, context);
  if (!flattened.ok()) return flattened.status();
  const absl::StatusOr<std::vector<DiscLeaves>> discs = disc_leaves(*flattened, options.points, context);
  if (!discs.ok()) return discs.status();
  Stopwatch watch;
  const absl::StatusOr<std::unique_ptr<IdBuffer>> id_buffer = IdBuffer::create();
  if (!id_buffer.ok()) return id_buffer.status();
  const double context_seconds = watch.lap();

  std::vector<double> exact_seconds, drawn_seconds;
  std::size_t leaves = 0, different = 0;
  IdBufferCounts counts;
  for (int i = 0; i < options.repeats; ++i) {
    context.progress("map", static_cast<double>(i) / options.repeats);
    leaves = different = 0;
    counts = {};
    double exact = 0, drawn = 0;
    for (std::size_t d = 0; d < discs->size(); ++d) {
      const DiscLeaves& disc = (*discs)[d];
      std::vector<std::uint32_t> by_lists(disc.leaves.size()), by_pictures(disc.leaves.size());
      watch.lap();
      locate_centres(disc.triangles, disc.leaves, by_lists);
      exact += watch.lap();
      absl::Status status =
          (*id_buffer)->locate(flattened->charts[d], disc.triangles, disc.leaves, by_pictures, context, &counts);
      if (!status.ok()) return status;
      drawn += watch.lap();
      leaves += disc.leaves.size();
      for (std::size_t l = 0; l < disc.leaves.size(); ++l) different += by_lists[l] != by_pictures[l];
    }
    exact_seconds.push_back(exact);
    drawn_seconds.push_back(drawn);
  }
  const auto share = [&](std::uint64_t count) { return static_cast<double>(count) / static_cast<double>(leaves); };
  const double exact = median(std::move(exact_seconds));
  BenchReport report{"mappers", {}};
  report.results = {{"exact", exact, "s"},
                    {"ID buffer", median(std::move(drawn_seconds)), "s", exact},
                    {"ID buffer: its context, once", context_seconds, "s"},
                    {"ID buffer: sections", static_cast<double>(counts.sections), "pictures"},
                    {"ID buffer: texels", share(counts.texels), "/centre"},
                    {"ID buffer: centres not under their texel's triangle", 100 * share(counts.walked), "%"},
                    {"ID buffer: centres to which no walk led", 100 * share(counts.searched), "%"},
                    {"centres with different triangles", 100 * share(different), "%"}};
  report.notes = {absl::StrFormat("%s: %d faces, %d discs, %d curve vertices; median of %d runs in turn.", file.name,
                                  flattened->loaded.info.faces, discs->size(), leaves, options.repeats),
                  "Triangles differ where a centre lies on their common edge, within rounding."};
  return report;
}

}  // namespace

absl::StatusOr<BenchReport> bench_mappers(const MeshFile& file, const MappersBenchOptions& options,
                                          const ExecutionContext& context) {
  return with_threads(context, [&] { return run(file, options, context); });
}

}  // namespace curvecast::cli::bench
