// What it costs to write a block of points, ours beside Draco's own encoder in one run; items are points.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <string>

#include "core/codec/delta_symbols.h"
#include "core/codec/draco_codec.h"
#include "core/codec/lattice.h"
#include "core/codec/octahedral.h"
#include "core/codec/symbol_writer.h"
#include "core/pipeline/pipeline.h"
#include "core/sample/resample.h"
#include "tests/support/draco_reference.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

constexpr std::size_t kPoints = 12'500;

PointSet points;  // of a sphere, in curve order
const DracoOptions kOptions = {.box_min = Vec3d(-1.25, -1.25, -1.25), .box_size = 2.5};

void count_points(benchmark::State& state) { state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPoints)); }

PointSet points_with(bool has_colours) {
  PointSet all = points;
  if (!has_colours) return all;
  for (const Vec3f& p : points.positions) {
    const auto channel = [&](int c) { return static_cast<std::uint8_t>(127 + 127 * p[c]); };
    all.colours.push_back({channel(0), channel(1), channel(2), 255});
  }
  return all;
}

void by_libdraco(benchmark::State& state) {
  const PointSet all = points_with(state.range(0) != 0);
  for (auto _ : state) benchmark::DoNotOptimize(testing::draco_reference(all, kOptions).size());
  count_points(state);
}

void encode(benchmark::State& state) {
  const PointSet all = points_with(state.range(0) != 0);
  float low = 0, high = 0;
  for (auto _ : state) benchmark::DoNotOptimize(encode_draco(all, kOptions, &low, &high)->size());
  count_points(state);
}

const Lattice kLattice = {.low = kOptions.box_min.cast<float>(), .size = static_cast<float>(kOptions.box_size)};

struct Symbols {
  std::vector<std::int32_t> values = std::vector<std::int32_t>(3 * kPoints);
  std::vector<std::uint32_t> positions = std::vector<std::uint32_t>(3 * kPoints);
  std::vector<std::uint32_t> normals = std::vector<std::uint32_t>(2 * kPoints);

  void take_positions() {
    benchmark::DoNotOptimize(to_lattice(kLattice, points.positions, values).ok());
    delta_symbols(values, 3, range_of(values), positions);
  }
  void take_normals() { octahedral_symbols(OctahedralLattice(kOptions.normal_bits), points.normals, normals); }
};

void position_symbols(benchmark::State& state) {
  Symbols symbols;
  for (auto _ : state) symbols.take_positions();
  count_points(state);
}

void normal_symbols(benchmark::State& state) {
  Symbols symbols;
  for (auto _ : state) {
    symbols.take_normals();
    benchmark::ClobberMemory();
  }
  count_points(state);
}

void count_symbols(benchmark::State& state) {
  Symbols symbols;
  symbols.take_positions();
  symbols.take_normals();
  for (auto _ : state) {
    SymbolWriter position(symbols.positions, 3), normal(symbols.normals, 2);
    benchmark::DoNotOptimize(position.run().table);
    benchmark::DoNotOptimize(normal.run().table);
  }
  count_points(state);
}

void code_symbols(benchmark::State& state) {
  Symbols symbols;
  symbols.take_positions();
  symbols.take_normals();
  SymbolWriter position(symbols.positions, 3), normal(symbols.normals, 2);
  RansRun* runs[] = {&position.run(), &normal.run()};
  for (auto _ : state) {
    code_runs(runs);
    benchmark::ClobberMemory();
  }
  count_points(state);
}

BENCHMARK(by_libdraco)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);
BENCHMARK(encode)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);
BENCHMARK(position_symbols)->Unit(benchmark::kMicrosecond);
BENCHMARK(normal_symbols)->Unit(benchmark::kMicrosecond);
BENCHMARK(count_symbols)->Unit(benchmark::kMicrosecond);
BENCHMARK(code_symbols)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace curvecast

int main(int argc, char** argv) {
  using curvecast::kPoints;
  benchmark::Initialize(&argc, argv);
  const std::string off = curvecast::testing::to_off(curvecast::testing::icosphere(5));
  const absl::StatusOr<curvecast::Preprocessed> done = curvecast::preprocess({"ball.off", off}, {.points = kPoints});
  absl::StatusOr<curvecast::PointSet> points = done.ok() ? curvecast::resample(*done->curve, {.points = kPoints}) : done.status();
  if (!points.ok()) {
    std::fprintf(stderr, "%s\n", std::string(points.status().message()).c_str());
    return 3;
  }
  curvecast::points = *std::move(points);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
