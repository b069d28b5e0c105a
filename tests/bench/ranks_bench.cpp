// What ranked points cost to make, of the whole surface and for a view from nearby.
//   ranks_bench [MESH] [--benchmark_...]      without a mesh: a generated torus
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/stopwatch.h"
#include "core/pipeline/curve_surface.h"
#include "core/progressive/grow_ranks.h"
#include "core/progressive/rank_delta.h"
#include "core/progressive/rank_selection.h"
#include "core/progressive/sample_ranked.h"
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
  std::size_t points = 0, made = 0, rounds = 0;
  for (auto _ : state) {
    state.PauseTiming();
    auto grower = RankGrower::make(surface, {.level = 8}, {.threads = 1}).value();
    const std::size_t before = grower->tree()->points();
    state.ResumeTiming();
    RankSelector selector;
    RankSelection selection;
    for (rounds = 0;; ++rounds) {
      selector.select(grower->tree(), nullptr, ViewFactor(curve, density), kPoints, selection);
      if (selection.lacking.empty() || !grower->grow(selection.most_lacking(), 100 * kPoints, {.threads = 1}).ok()) break;
    }
    points = selection.count;
    made = grower->tree()->points() - before;
  }
  state.counters["points"] = static_cast<double>(points);
  state.counters["made"] = static_cast<double>(made);
  state.counters["rounds"] = static_cast<double>(rounds);
}

/// A camera that goes from the whole mesh to a 2,000th of its size from its surface: `part`, from 0 to 1, of the way.
Density zoomed(double part) {
  const SurfaceCurve& curve = surface->curve();
  const std::size_t l = curve.size() / 3;
  const Vec3d place = curve.position(l).cast<double>() + curve.origin;
  const double distance = curve.box.diagonal() * 1.25 * std::pow(2500.0, -part);
  return Density({ScreenTerm{}, FrustumTerm{}}, {testing::camera_at(place + distance * curve.normal(l).cast<double>(), place)});
}

/// A camera that goes once around the whole mesh: `part`, from 0 to 1, of the way.
Camera around(double part) {
  const Box3d& box = surface->curve().box;
  const Vec3d middle = box.center();
  const double angle = 2 * M_PI * part;
  return testing::camera_at(middle + 1.25 * box.diagonal() * Vec3d(std::cos(angle), 0.3, std::sin(angle)), middle);
}

/// Fills the caches with something else, as what happens between two views of a server does.
void cool_caches() {
  static std::vector<char> other(std::size_t{96} << 20);
  for (std::size_t i = 0; i < other.size(); i += 64) ++other[i];
  benchmark::DoNotOptimize(other.data());
}

/// Selecting views around the mesh, on ranks that are there: with a picture term or a screen and a frustum term, whether caches
/// are cold.
void orbit(benchmark::State& state) {
  constexpr int kSteps = 150;
  const SurfaceCurve& curve = surface->curve();
  const auto density = [&](int i) {
    const Camera camera = around(static_cast<double>(i) / kSteps);
    return state.range(0) != 0 ? Density({PictureTerm{}}, {camera}) : Density({ScreenTerm{}, FrustumTerm{}}, {camera});
  };
  const auto grower = RankGrower::make(surface, {.level = 8}, {}).value();
  RankedWorkspace workspace;
  for (int i = 0; i < kSteps; ++i) {
    for (;;) {
      if (!select_ranked(curve, grower->tree(), nullptr, density(i), kPoints, workspace).ok()) return;
      const auto lacking = workspace.selection.most_lacking();
      if (lacking.empty() || !grower->grow(lacking, 1'000 * kPoints, {}).ok()) break;
    }
  }
  for (auto _ : state) {
    double seconds = 0, expected = 0;
    for (int i = 0; i < kSteps; ++i) {
      if (state.range(1) != 0) cool_caches();
      const Density now = density(i);
      Stopwatch watch;
      if (!select_ranked(curve, grower->tree(), nullptr, now, kPoints, workspace, expected).ok()) return;
      seconds += watch.lap();
      expected = workspace.selection.similar_scale();
    }
    state.SetIterationTime(seconds / kSteps);
  }
}

/// What changes from view to view on the way down, on ranks that are there: points of the views, steps of the way, whether
/// caches are cold.
void step(benchmark::State& state) {
  const SurfaceCurve& curve = surface->curve();
  const auto points = static_cast<std::uint64_t>(state.range(0));
  const int steps = static_cast<int>(state.range(1));
  static std::map<std::uint64_t, std::unique_ptr<RankGrower>> growers;
  std::unique_ptr<RankGrower>& grower = growers[points];
  RankedWorkspace before, after;
  if (grower == nullptr) {
    grower = RankGrower::make(surface, {.level = 8}, {}).value();
    for (int i = 0; i <= 180; ++i) {
      for (;;) {
        if (!select_ranked(curve, grower->tree(), nullptr, zoomed(i / 180.0), points, after).ok()) return;
        if (after.selection.lacking.empty() || !grower->grow(after.selection.most_lacking(), 1'000 * kPoints, {}).ok()) break;
      }
    }
  }
  double seconds[3] = {};
  std::size_t changes = 0, count = 0, visited = 0;
  for (auto _ : state) {
    for (int i = 0; i <= steps; ++i) {
      if (state.range(2) != 0) cool_caches();
      Stopwatch watch;
      const double expected = i > 0 ? before.selection.similar_scale() : 0;
      if (!select_ranked(curve, grower->tree(), nullptr, zoomed(static_cast<double>(i) / steps), points, after, expected).ok())
        return;
      const double selecting = watch.lap();
      if (i > 0) {
        RankDelta& delta = after.delta;
        compare(before.selection, before.selection.rungs, after.selection, delta);
        const double comparing = watch.lap();
        changes += delta.added.size() + delta.removed.size() + delta.resized.size();
        locate(before.selection, after.selection, delta, after.list_delta);
        seconds[0] += selecting, seconds[1] += comparing, seconds[2] += watch.lap();
        visited += after.selection.shown.size() * 64;
        ++count;
      }
      std::swap(before.selection, after.selection);
    }
  }
  const auto n = static_cast<double>(count);
  state.counters["select_us"] = 1e6 * seconds[0] / n;
  state.counters["compare_us"] = 1e6 * seconds[1] / n;
  state.counters["locate_us"] = 1e6 * seconds[2] / n;
  state.counters["changes"] = static_cast<double>(changes) / n;
  state.counters["visited"] = static_cast<double>(visited) / n;
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
BENCHMARK(step)->ArgsProduct({{20'000, 50'000}, {180, 3'000}, {0}})->Unit(benchmark::kMillisecond);
BENCHMARK(step)->ArgsProduct({{20'000, 50'000}, {180}, {1}})->Unit(benchmark::kMillisecond);
BENCHMARK(orbit)->ArgNames({"picture", "cold"})->ArgsProduct({{0, 1}, {0, 1}})->UseManualTime()->Unit(benchmark::kMicrosecond);
BENCHMARK(deepen)->Arg(5)->Arg(50)->Arg(500)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace curvecast

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (!curvecast::load(argc > 1 ? argv[1] : "")) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
