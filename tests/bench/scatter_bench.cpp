// What points straight on a mesh cost, step by step, beside reading the mesh once, and what a curve over its charts takes for as
// many. On one thread, 16,384 points.
//   scatter_bench MESH [--benchmark_...]
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "core/mesh/crease_normals.h"
#include "core/mesh/curvature.h"
#include "core/mesh/face_order.h"
#include "core/mesh_io/mesh_io.h"
#include "core/pipeline/pipeline.h"
#include "core/sample/face_curve.h"
#include "core/sample/resample.h"
#include "core/sample/scatter.h"

namespace curvecast {
namespace {

constexpr std::uint64_t kPoints = 16'384;
const ExecutionContext kAlone{.threads = 1};

PolygonSoup soup;
LoadedMesh mesh;
std::vector<VertexGeometry> normals;
CreaseNormals creases;
SurfaceData data;

/// The most that memory gives one thread: sums the mesh's arrays once.
void read_arrays(benchmark::State& state) {
  for (auto _ : state) {
    Vec3d sum = std::accumulate(mesh.mesh.positions.begin(), mesh.mesh.positions.end(), Vec3d(Vec3d::Zero()));
    benchmark::DoNotOptimize(sum);
    std::uint64_t corners = 0;
    for (const Triangle& t : mesh.mesh.triangles) corners += t[0] + t[1] + t[2];
    benchmark::DoNotOptimize(corners);
  }
}

void repair(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(load_mesh(PolygonSoup(soup), "mesh", kAlone).ok());
}

void find_normals(benchmark::State& state) {
  for (auto _ : state) {
    const VertexFans fans(mesh.mesh);
    benchmark::DoNotOptimize(vertex_normals(mesh.mesh, fans, kAlone).size());
    benchmark::DoNotOptimize(crease_normals(mesh.mesh, kCreaseDegrees, fans, kAlone).faces.size());
  }
}

void order_faces(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(face_order(mesh.mesh, kAlone).size());
}

/// Rounds of blue noise.
void scatter_points(benchmark::State& state) {
  const ScatterOptions options{.points = kPoints, .rounds = static_cast<int>(state.range(0))};
  for (auto _ : state) benchmark::DoNotOptimize(scatter(mesh.mesh, data, {}, options, kAlone).ok());
}

/// All of it, from a soup.
void scatter_all(benchmark::State& state) {
  for (auto _ : state) {
    const absl::StatusOr<LoadedMesh> loaded = load_mesh(PolygonSoup(soup), "mesh", kAlone);
    const VertexFans fans(loaded->mesh);
    const std::vector<VertexGeometry> of_vertices = vertex_normals(loaded->mesh, fans, kAlone);
    const CreaseNormals of_creases = crease_normals(loaded->mesh, kCreaseDegrees, fans, kAlone);
    const SurfaceData all(loaded->mesh, of_vertices, of_creases, loaded->attributes);
    benchmark::DoNotOptimize(scatter(loaded->mesh, all, {}, {.points = kPoints}, kAlone).ok());
  }
}

/// The same number of points of a curve over charts, from a soup.
void resample_all(benchmark::State& state) {
  const PreprocessOptions options{.points = kPoints};
  for (auto _ : state) {
    absl::StatusOr<LoadedMesh> loaded = load_mesh(PolygonSoup(soup), "mesh", kAlone);
    absl::StatusOr<FlattenedMesh> flattened = flatten_mesh(*std::move(loaded), options, kAlone);
    const auto made = lay_curve(std::make_shared<const FlattenedMesh>(*std::move(flattened)), options, kAlone);
    benchmark::DoNotOptimize(resample(*made->curve, {.points = kPoints}).ok());
  }
}

BENCHMARK(read_arrays)->Unit(benchmark::kMillisecond);
BENCHMARK(repair)->Unit(benchmark::kMillisecond);
BENCHMARK(find_normals)->Unit(benchmark::kMillisecond);
BENCHMARK(order_faces)->Unit(benchmark::kMillisecond);
BENCHMARK(scatter_points)->Arg(0)->Arg(1)->Arg(2)->Arg(10)->Unit(benchmark::kMillisecond);
BENCHMARK(scatter_all)->Unit(benchmark::kMillisecond);
BENCHMARK(resample_all)->Unit(benchmark::kMillisecond);

/// Reads the mesh. False, with a message, where that fails.
bool prepare(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  absl::StatusOr<PolygonSoup> read = read_mesh({path, bytes}, kAlone);
  absl::StatusOr<LoadedMesh> loaded = read.ok() ? load_mesh(PolygonSoup(*read), path, kAlone) : read.status();
  if (!loaded.ok()) {
    std::fprintf(stderr, "%s\n", std::string(loaded.status().message()).c_str());
    return false;
  }
  soup = *std::move(read), mesh = *std::move(loaded);
  const VertexFans fans(mesh.mesh);
  normals = vertex_normals(mesh.mesh, fans, kAlone);
  creases = crease_normals(mesh.mesh, kCreaseDegrees, fans, kAlone);
  data = SurfaceData(mesh.mesh, normals, creases, mesh.attributes);
  return true;
}

}  // namespace
}  // namespace curvecast

int main(int argc, char** argv) try {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  benchmark::Initialize(&argc, argv);
  if (argc < 2) {
    std::fprintf(stderr, "usage: scatter_bench MESH [--benchmark_...]\n");
    return 2;
  }
  if (!curvecast::prepare(argv[1])) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
