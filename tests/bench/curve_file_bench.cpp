// What saving and loading a curve cost, step by step, beside reading the same bytes once.
//   curve_file_bench MESH FOLDER [--benchmark_...]      the file is written to FOLDER and removed
#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <string>

#include "core/pipeline/curve_surface.h"
#include "core/pipeline/pipeline.h"
#include "core/storage/curve_file.h"
#include "core/storage/surface_file.h"

namespace curvecast {
namespace {

Preprocessed made;
std::string path, surface_path;

/// Bytes of the file per second.
void count_bytes(benchmark::State& state, const std::string& file) {
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                          static_cast<std::int64_t>(std::filesystem::file_size(file)));
}

/// The most that memory gives one thread: sums as many bytes as the file has, already in memory.
void read_memory(benchmark::State& state) {
  const std::vector<std::uint64_t> words(std::filesystem::file_size(path) / 8, 1);
  for (auto _ : state) benchmark::DoNotOptimize(std::accumulate(words.begin(), words.end(), std::uint64_t{0}));
  count_bytes(state, path);
}

void load(benchmark::State& state) {
  for (auto _ : state) {
    const auto loaded = load_curve(path, state.range(0) == 0 ? FileAccess::kMap : FileAccess::kCopy);
    if (!loaded.ok()) state.SkipWithError("cannot load");
    benchmark::DoNotOptimize(loaded->curve->size());
  }
  count_bytes(state, path);
}

void check(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(check_curve(*made.curve).ok());
  count_bytes(state, path);
}

void save(benchmark::State& state) {
  for (auto _ : state) {
    if (!save_curve(path, *made.curve).ok()) state.SkipWithError("cannot save");
  }
  count_bytes(state, path);
}

void load_refinement(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(open_surface(surface_path).ok());
  count_bytes(state, surface_path);
}

BENCHMARK(read_memory)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(load)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(check)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(save)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(load_refinement)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace curvecast

int main(int argc, char** argv) {
  using namespace curvecast;
  benchmark::Initialize(&argc, argv);
  if (argc != 3) return std::fprintf(stderr, "curve_file_bench MESH FOLDER\n"), 2;
  std::ifstream file(argv[1], std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  absl::StatusOr<Preprocessed> result = preprocess({argv[1], bytes}, {});
  if (!result.ok()) return std::fprintf(stderr, "%s\n", result.status().ToString().c_str()), 3;
  made = *std::move(result);
  path = std::string(argv[2]) + "/curve_file_bench.curve";
  surface_path = std::string(argv[2]) + "/curve_file_bench.surface";
  const absl::Status saved = save_curve(path, *made.curve);
  if (!saved.ok() || !save_surface(surface_path, **curve_base(made.flattened)).ok()) {
    return std::fprintf(stderr, "%s\n", saved.ToString().c_str()), 3;
  }
  std::printf("%zu curve vertices, %zu bytes of columns, files of %ju and %ju bytes\n", made.curve->size(),
              made.curve->byte_size(), std::filesystem::file_size(path), std::filesystem::file_size(surface_path));
  benchmark::RunSpecifiedBenchmarks();
  std::filesystem::remove(path);
  std::filesystem::remove(surface_path);
  return 0;
}
