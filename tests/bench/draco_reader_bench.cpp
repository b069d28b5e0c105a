// The client's own reader beside Draco's decoder, on the blocks of one frame.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <string>
#include <vector>

#include "client/lib/draco/draco_library.h"
#include "client/lib/draco/draco_reader.h"
#include "client/lib/point_blocks.h"
#include "client/lib/protocol.h"
#include "tests/client/draco/draco_clouds.h"

namespace curvecast::client {
namespace {

constexpr std::size_t kBlocks = 4, kPointsPerBlock = 12'500;
constexpr RadiusRange kRadii{0.001F, 0.5F};

/// Arguments: bits of positions and of normals.
std::string block_of(const benchmark::State& state) {
  return draco_cloud({.points = kPointsPerBlock,
                      .position_bits = static_cast<int>(state.range(0)),
                      .normal_bits = static_cast<int>(state.range(1))});
}

DecodedPoints room() {
  DecodedPoints points;
  points.positions.resize(kPointsPerBlock);
  points.normals.resize(kPointsPerBlock);
  points.radii.resize(kPointsPerBlock);
  return points;
}

void count_points(benchmark::State& state) {
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * kBlocks * kPointsPerBlock));
}

template <typename Decode>
void decode_blocks_with(benchmark::State& state, Decode&& decode) {
  const std::string bytes = block_of(state);
  DecodedPoints points = room();
  const PointColumns to = points.columns();
  for (auto _ : state) {
    for (std::size_t block = 0; block < kBlocks; ++block) {
      const auto header = check_draco_header(bytes, kMaxPoints);
      if (!header.ok() || !decode(bytes, *header, to)) return state.SkipWithError("the points cannot be decoded");
    }
    benchmark::DoNotOptimize(points.positions.data());
  }
  count_points(state);
}

void own_reader(benchmark::State& state) {
  DracoReader reader;
  decode_blocks_with(state, [&](const std::string& bytes, const DracoHeaderInfo& header, const PointColumns& to) {
    return reader.read(bytes, header, kRadii, to).value_or(false);
  });
}

void draco_decoder(benchmark::State& state) {
  decode_blocks_with(state, [](const std::string& bytes, const DracoHeaderInfo& header, const PointColumns& to) {
    return decode_with_draco(bytes, header, kRadii, to).ok();
  });
}

/// With room for the points and as many threads as pay.
void whole_frame(benchmark::State& state) {
  google::protobuf::RepeatedPtrField<v1::PointBlock> blocks;
  for (std::size_t i = 0; i < kBlocks; ++i) {
    v1::PointBlock* block = blocks.Add();
    block->set_count(kPointsPerBlock);
    block->mutable_draco()->set_data(block_of(state));
    block->mutable_draco()->set_radius_min(kRadii.min);
    block->mutable_draco()->set_radius_max(kRadii.max);
  }
  for (auto _ : state) {
    const auto points = decode_blocks(blocks);
    if (!points.ok()) return state.SkipWithError("the points cannot be decoded");
    benchmark::DoNotOptimize(points->positions.data());
  }
  count_points(state);
}

void bits(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"position_bits", "normal_bits"})
      ->Args({11, 8})
      ->Args({14, 10})
      ->Args({16, 10})
      ->Unit(benchmark::kMillisecond);
}

BENCHMARK(own_reader)->Apply(bits);
BENCHMARK(draco_decoder)->Apply(bits);
BENCHMARK(whole_frame)->Apply(bits)->UseRealTime();

}  // namespace
}  // namespace curvecast::client

BENCHMARK_MAIN();
