// What ranked points cost to make, of the whole surface and for a view from nearby.
//   ranks_bench [MESH] [--benchmark_...]      without a mesh: a generated torus
#include <benchmark/benchmark.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "core/pipeline/curve_surface.h"
#include "core/progressive/grow_ranks.h"
#include "core/progressive/rank_selection.h"
#include "tests/support/shapes.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

constexpr std::uint64_t kPoints = 50'000;

std::shared_ptr<const LeafSurface> surface;

/// The ranks of the whole surface down to a level, by one thread.
void make_ranks(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(ProgressiveRanks::make(surface, {.level = static_cast<int>(state.range(0))}, {.threads = 1}).ok());
  }
  state.SetItemsProcessed(state.iterations() << 2 * state.range(0));
}

/// All ranks that a view needs whose eye is at a part of the mesh's diagonal from the surface, 1 / the argument, by one thread;
/// those of the 65,536 lowest ranks are there.
void deepen(benchmark::State& state) {
  const SurfaceCurve& curve = surface->curve();
  const std::size_t l = curve.size() / 3;
  const Vec3d place = curve.position(l).cast<double>() + curve.origin;
  const double distance = curve.box.diagonal() / static_cast<double>(state.range(0));
  const Density density({ScreenTerm{}, FrustumTerm{}},
                        {testing::camera_at(place + distance * curve.normal(l).cast<double>(), place)});
  std::size_t points = 0, made = 0;
  for (auto _ : state) {
    state.PauseTiming();
    auto grower = RankGrower::make(surface, {.level = 8}, {.threads = 1}).value();
    const std::size_t before = grower->tree()->points();
    state.ResumeTiming();
    RankSelector selector;
    RankSelection selection;
    for (;;) {
      selector.select(grower->tree(), nullptr, ViewFactor(curve, density), kPoints, selection);
      if (selection.lacking.empty() || !grower->grow(selection.lacking, 100 * kPoints, {.threads = 1}).ok()) break;
    }
    points = selection.count;
    made = grower->tree()->points() - before;
  }
  state.counters["points"] = static_cast<double>(points);
  state.counters["made"] = static_cast<double>(made);
}

bool load(const std::string& path) {
  std::string bytes;
  if (path.empty()) {
    bytes = testing::to_off(testing::torus(300, 150));
  } else {
    std::ifstream file(path, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(file), {});
  }
  const absl::StatusOr<Preprocessed> made = preprocess({path.empty() ? "torus.off" : path, bytes}, {});
  if (!made.ok()) {
    std::fprintf(stderr, "ranks_bench: %s\n", made.status().ToString().c_str());
    return false;
  }
  surface = leaf_surface(*made);
  return true;
}

BENCHMARK(make_ranks)->DenseRange(7, 9)->Unit(benchmark::kMillisecond);
BENCHMARK(deepen)->Arg(5)->Arg(50)->Arg(500)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace curvecast

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (!curvecast::load(argc > 1 ? argv[1] : "")) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
