// What a new view costs, stage by stage, beside the cost of reading the same arrays once.
//   resample_bench [MESH] [--benchmark_...]      without a mesh: a generated torus
#include <benchmark/benchmark.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "client/bench/read_bytes.h"
#include "core/codec/draco_codec.h"
#include "core/density/fixed_density.h"
#include "core/pipeline/pipeline.h"
#include "core/sample/equalise.h"
#include "core/sample/resample.h"
#include "core/sample/view_mass.h"
#include "tests/support/shapes.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

constexpr std::uint64_t kPoints = 50'000;

std::shared_ptr<const SurfaceCurve> curve;

ResampleOptions view_options() {
  ResampleOptions options;
  options.points = kPoints;
  options.density = testing::seen_from(curve->box.center() + Vec3d(0.3, 0.5, 2) * curve->box.diagonal());
  return options;
}

/// Seconds per curve vertex are shown as items per second.
void count_vertices(benchmark::State& state) {
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(curve->size()));
}

void read_arrays(benchmark::State& state) {
  for (auto _ : state) {
    std::uint64_t sum = 0;
    for (const Column<float>* column : {&curve->x, &curve->y, &curve->z, &curve->area}) sum += cli::bench::read_bytes(*column);
    for (const Column<Snorm16>* column : {&curve->nx, &curve->ny, &curve->nz}) sum += cli::bench::read_bytes(*column);
    benchmark::DoNotOptimize(sum);
  }
  count_vertices(state);
}

void density(benchmark::State& state) {
  std::vector<float> values(curve->size());
  const ResampleOptions options = view_options();
  for (auto _ : state) benchmark::DoNotOptimize(evaluate_density(*curve, options.density, values).ok());
  count_vertices(state);
}

/// So many dabs, each a twentieth of the surface's size, along the curve.
BrushTerm brush_of(std::size_t n) {
  BrushTerm brush;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d place = curve->origin + curve->position(i * (curve->size() - 1) / n).cast<double>();
    brush.dabs.push_back({place, 0.05 * curve->box.diagonal(), 8, 0.5});
  }
  return brush;
}

/// The density of many dabs, from nothing.
void paint_all(benchmark::State& state) {
  const std::vector<DensityTerm> terms = {brush_of(static_cast<std::size_t>(state.range(0)))};
  for (auto _ : state) benchmark::DoNotOptimize(make_fixed_density(*curve, terms).value());
}

/// The density of one dab more.
void paint_one_more(benchmark::State& state) {
  const auto n = static_cast<std::size_t>(state.range(0));
  const BrushTerm more = brush_of(n);
  const std::vector<DensityTerm> terms = {more}, before = {BrushTerm{{more.dabs.begin(), more.dabs.end() - 1}}};
  const EarlierPaint earlier{make_fixed_density(*curve, before).value(), n - 1};
  for (auto _ : state) benchmark::DoNotOptimize(make_fixed_density(*curve, terms, earlier).value());
}

void view_blocks(benchmark::State& state) {
  const ResampleOptions options = view_options();
  ViewMass mass;
  for (auto _ : state) {
    view_mass(*curve, {}, curve->blocks.area, ViewFactor(*curve, options.density), kPoints, mass);
    benchmark::DoNotOptimize(mass.total);
  }
  state.counters["close"] = static_cast<double>(mass.own_codes.size()) / static_cast<double>(mass.sum.size());
}

void equalise_view(benchmark::State& state) {
  const ResampleOptions options = view_options();
  ViewMass mass;
  view_mass(*curve, {}, curve->blocks.area, ViewFactor(*curve, options.density), kPoints, mass);
  std::vector<double> q(kPoints);
  fill_sequence(Sequence::kJittered, 1, q);
  std::vector<std::uint32_t> vertices(kPoints);
  EqualiseScratch scratch;
  for (auto _ : state) {
    equalise(mass, curve->blocks.area, q, vertices, scratch);
    benchmark::DoNotOptimize(vertices.data());
  }
}

void sequence(benchmark::State& state) {
  std::vector<double> q(kPoints);
  for (auto _ : state) {
    fill_sequence(static_cast<Sequence>(state.range(0)), 1, q);
    benchmark::DoNotOptimize(q.data());
  }
}

void resample_with(benchmark::State& state, const ResampleOptions& options) {
  const auto fixed = make_fixed_density(*curve, options.density.terms);
  ResampleWorkspace workspace;
  for (auto _ : state) {
    benchmark::DoNotOptimize(resample(*curve, fixed->get(), options, workspace).ok());
    benchmark::DoNotOptimize(workspace.points.positions.data());
  }
}

void resample_evenly(benchmark::State& state) { resample_with(state, {.points = 65'536}); }

void resample_curved(benchmark::State& state) {
  ResampleOptions options{.points = 65'536};
  options.density.terms.emplace_back(CurvatureTerm{});
  resample_with(state, options);
}

void resample_view(benchmark::State& state) { resample_with(state, view_options()); }

void resample_curved_view(benchmark::State& state) {
  ResampleOptions options = view_options();
  options.density.terms.emplace_back(CurvatureTerm{});
  resample_with(state, options);
}

void resample_once(benchmark::State& state) {
  const ResampleOptions options = view_options();
  for (auto _ : state) benchmark::DoNotOptimize(resample(*curve, options)->size());
  count_vertices(state);
}

void encode(benchmark::State& state) {
  const absl::StatusOr<PointSet> points = resample(*curve, view_options());
  DracoOptions options;
  options.box_min = curve->box.min - curve->origin;
  options.box_size = (curve->box.max - curve->box.min).maxCoeff();
  float smallest, largest;
  for (auto _ : state) benchmark::DoNotOptimize(encode_draco(*points, options, &smallest, &largest)->size());
}

BENCHMARK(read_arrays)->Unit(benchmark::kMillisecond);
BENCHMARK(density)->Unit(benchmark::kMillisecond);
BENCHMARK(paint_all)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK(paint_one_more)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK(view_blocks)->Unit(benchmark::kMillisecond);
BENCHMARK(sequence)->DenseRange(0, 3)->Unit(benchmark::kMillisecond);
BENCHMARK(resample_evenly)->Unit(benchmark::kMillisecond);
BENCHMARK(equalise_view)->Unit(benchmark::kMillisecond);
BENCHMARK(resample_curved)->Unit(benchmark::kMillisecond);
BENCHMARK(resample_view)->Unit(benchmark::kMillisecond);
BENCHMARK(resample_curved_view)->Unit(benchmark::kMillisecond);
BENCHMARK(resample_once)->Unit(benchmark::kMillisecond);
BENCHMARK(encode)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace curvecast

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  std::string name = "torus.off";
  std::string bytes;
  if (argc > 1) {
    name = argv[1];
    std::ifstream file(name, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(file), {});
  } else {
    bytes = curvecast::testing::to_off(curvecast::testing::torus(300, 150));
  }
  absl::StatusOr<curvecast::Preprocessed> preprocessed = curvecast::preprocess({name, bytes}, {});
  if (!preprocessed.ok()) {
    std::fprintf(stderr, "%s\n", std::string(preprocessed.status().message()).c_str());
    return 3;
  }
  curvecast::curve = preprocessed->curve;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
