// Small meshes of odd places and arbitrary triangles through all of preprocessing, and one point set of what comes out.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/base/memory_claim.h"
#include "core/measure/triangle_tree.h"
#include "core/pipeline/pipeline.h"
#include "core/sample/resample.h"
#include "core/storage/curve_file.h"
#include "tests/fuzz/fuzz_bytes.h"
#include "tests/fuzz/fuzz_expect.h"
#include "tests/fuzz/fuzz_input.h"

namespace curvecast::fuzzing {
namespace {

constexpr std::size_t kMostFaces = 300;
constexpr std::uint64_t kMostMemory = std::uint64_t{64} << 20;

/// Mostly multiples of a sixteenth, so that vertices meet; else what numbers can be at their worst.
double coordinate(std::uint8_t byte) {
  using Limits = std::numeric_limits<double>;
  constexpr std::array<double, 16> kOdd = {-0.0,
                                           5e-324,
                                           1e-300,
                                           -1e-40,
                                           1e-12,
                                           1.0 + 1e-15,
                                           1e7,
                                           -1e20,
                                           1e38,
                                           3.5e38,
                                           -1e155,
                                           1e300,
                                           Limits::max(),
                                           Limits::infinity(),
                                           -Limits::infinity(),
                                           Limits::quiet_NaN()};
  constexpr int kFirstOdd = 256 - static_cast<int>(kOdd.size());
  return byte < kFirstOdd ? (byte - kFirstOdd / 2) / 16.0 : kOdd.at(byte - kFirstOdd);
}

template <typename T>
void append(std::string& bytes, T value) {
  static_assert(std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// As a PLY file.
std::string mesh_of(Bytes& bytes) {
  constexpr std::array<double, 8> kScales = {1, 1, 1, 1, 1e-6, 1e6, 1e-30, 1e30}, kOffsets = {0, 0, 0, 0, 0, 1e3, -1e7, 1e12};
  const std::uint8_t where = bytes.take();
  const double scale = kScales.at(where % 8), offset = kOffsets.at(where / 8 % 8);
  const std::uint32_t vertices = 3 + bytes.take() % 125;
  std::string body;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    for (int i = 0; i < 3; ++i) append(body, scale * coordinate(bytes.take()) + offset);
    append(body, static_cast<float>(coordinate(static_cast<std::uint8_t>(37 * v))));
  }
  std::size_t faces = 0;
  for (; faces < kMostFaces && !bytes.empty(); ++faces) {
    append(body, std::uint8_t{3});
    for (int i = 0; i < 3; ++i) append(body, bytes.take() % vertices);
  }
  return "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(vertices) +
         "\nproperty double x\nproperty double y\nproperty double z\nproperty float heat\nelement face " + std::to_string(faces) +
         "\nproperty list uchar uint vertex_indices\nend_header\n" + body;
}

PreprocessOptions options_of(Bytes& bytes) {
  PreprocessOptions options;
  options.points = 1 + bytes.take() % 20 * (bytes.take() % 21);  // mostly few, which take less time
  options.omega = 1 + bytes.take() % 12;
  const std::uint8_t ways = bytes.take(), density = bytes.take();
  options.parameteriser = ways % 16 == 0 ? Parameteriser::kCgal : Parameteriser::kLeastStretch;
  options.area_element = ways / 16 % 4 == 0 ? AreaElement::kVoronoi : AreaElement::kExact;
  options.chart_faces = ways / 64 == 0 ? 20 : 0;
  constexpr double kCreases[] = {kCreaseDegrees, 0, 180, 15};
  options.crease_degrees = kCreases[density / 8 % 4];
  if (density % 8 == 1) options.density.emplace_back(CurvatureTerm{});
  if (density % 8 == 2) options.density.emplace_back(AttributeTerm{"heat"});
  if (density % 8 == 3) options.density.emplace_back(ExpressionTerm{"x * x + abs(mean)"});
  return options;
}

/// Grants what an input may take, and no more.
class Budget final : public MemorySource {
 public:
  absl::Status take(std::uint64_t bytes, const std::string& what) override {
    if (taken_ + bytes > kMostMemory) return absl::ResourceExhaustedError(what);
    taken_ += bytes;
    return absl::OkStatus();
  }
  void give_back(std::uint64_t bytes) override { taken_ -= bytes; }
  std::uint64_t most() const override { return kMostMemory; }
  std::uint64_t taken() const { return taken_; }

 private:
  std::atomic<std::uint64_t> taken_ = 0;
};

void expect_on_surface(const PointSet& points, const Preprocessed& made) {
  const TriangleMesh& mesh = made.flattened->loaded.mesh;
  const Box3d box = bounding_box(mesh);
  for (const Vec3f& p : points.positions) expect(p.allFinite(), "a point that is nowhere");
  const TriangleTree tree(mesh);
  const double reach = std::max(box.min.norm(), box.max.norm());
  for (const Vec3f& p : points.positions) {
    const Vec3d relative = p.cast<double>();  // in floats, to an origin in doubles
    const double tolerance = 1e-5 * (box.diagonal() + relative.cwiseAbs().maxCoeff()) + 1e-14 * reach;
    expect(tree.nearest(points.origin + relative).distance <= tolerance, "a point that is not on the surface");
  }
}

void expect_point_set(const Preprocessed& made, std::uint64_t wanted) {
  const absl::StatusOr<PointSet> points = resample(*made.curve, {.points = wanted, .seed = 1});
  expect(points.ok(), points.status().ToString());
  expect(points->size() == wanted, "another number of points");
  expect_on_surface(*points, made);
}

}  // namespace

void take_input(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const PreprocessOptions options = options_of(bytes);
  const std::uint8_t ending = bytes.take();
  const unsigned cancel_at = ending % 4 == 3 ? 1 + ending / 4 : 0;  // the sign of progress at which it is cancelled; 0: never
  const std::string file = mesh_of(bytes);

  Budget budget;
  std::atomic<bool> cancel = false;
  unsigned signs = 0;
  const ExecutionContext context = {.on_progress =
                                        [&](std::string_view stage, double fraction) {
                                          expect(!stage.empty() && fraction >= 0 && fraction <= 1, "progress out of range");
                                          if (++signs == cancel_at) cancel = true;
                                        },
                                    .cancel = &cancel,
                                    .threads = 1,
                                    .memory = &budget};
  const absl::StatusOr<Preprocessed> made = preprocess({"a.ply", file}, options, context);
  expect(budget.taken() == 0, "memory that is not given back");
  if (!made.ok()) {
    const absl::Status& status = made.status();
    const bool is_nowhere = absl::IsFailedPrecondition(status) && !options.density.empty();  // the density is zero
    expect(absl::IsInvalidArgument(status) || absl::IsResourceExhausted(status) || (absl::IsCancelled(status) && cancel) ||
               is_nowhere,
           status.ToString());
    expect(!status.message().empty(), "an error without a reason");
    return;
  }
  const absl::Status checked = check_curve(*made->curve);
  expect(checked.ok(), checked.ToString());
  expect(made->report.flipped_triangles == 0, "flipped triangles");
  expect(made->report.discs == made->flattened->charts.size() && made->curve->disc_begin.size() == made->report.discs + 1,
         "another number of discs");
  expect_point_set(*made, options.points);
}

}  // namespace curvecast::fuzzing
