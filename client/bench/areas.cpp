#include "client/bench/areas.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "client/bench/disc_leaves.h"
#include "core/base/random.h"
#include "core/base/stopwatch.h"
#include "core/curve/surface_map.h"
#include "core/measure/gradient.h"
#include "core/measure/ring_discrepancy.h"
#include "core/reference/voronoi_area.h"
#include "core/sample/equalise.h"
#include "core/sample/sequence.h"

namespace curvecast::cli::bench {
namespace {

enum Kind { kExact, kVoronoi, kRandom };
constexpr std::array<const char*, 3> kNames = {"exact", "Voronoi", "random samples"};

/// Both columns of area elements, normalised, and what they took.
struct Elements {
  std::array<std::vector<float>, 2> area;
  std::array<double, 2> seconds{}, sum{};
};

absl::StatusOr<Elements> make_elements(const FlattenedMesh& flattened, const SurfaceCurve& curve,
                                       const AreasBenchOptions& options, const ExecutionContext& context) {
  const absl::StatusOr<std::vector<DiscLeaves>> discs = disc_leaves(flattened, options.points, context);
  if (!discs.ok()) return discs.status();
  Elements elements;
  for (std::vector<float>& area : elements.area) area.resize(curve.size());
  for (std::size_t d = 0; d < discs->size(); ++d) {
    const auto& [triangles, leaves] = (*discs)[d];
    const auto of_disc = [&, count = leaves.size()](auto& column) {
      return std::span(column).subspan(curve.disc_begin[d], count);
    };
    std::vector<std::uint32_t> under(leaves.size());
    locate_centres(triangles, leaves, under);
    Stopwatch watch;
    elements.sum[kExact] += area_elements(triangles, leaves, of_disc(elements.area[kExact]));
    elements.seconds[kExact] += watch.lap();
    const LeafVertices vertices{of_disc(curve.x), of_disc(curve.y), of_disc(curve.z), under, curve.origin};
    elements.sum[kVoronoi] += voronoi_areas(flattened.charts[d], triangles, leaves, vertices, of_disc(elements.area[kVoronoi]));
    elements.seconds[kVoronoi] += watch.lap();
  }
  for (std::vector<float>& area : elements.area) normalise_areas(curve.total_area, area);
  return elements;
}

/// Faces of n samples.
std::vector<std::uint32_t> draw(Kind kind, std::size_t n, std::uint64_t seed, const SurfaceCurve& curve, const Elements& elements,
                                std::span<const float> density) {
  std::vector<double> q(n);
  fill_sequence(Sequence::kJittered, seed, q);
  if (kind == kRandom) {
    for (std::size_t i = 0; i < n; ++i) q[i] = random_unit(seed, i);
    std::sort(q.begin(), q.end());
  }
  std::vector<std::uint32_t> samples(n);
  const BlockMass fixed = block_mass(density, elements.area[kind == kVoronoi ? kVoronoi : kExact]);
  ViewMass mass;
  fixed_mass(fixed, mass);
  equalise(mass, fixed, q, samples);
  for (std::uint32_t& sample : samples) sample = curve.triangle[sample];
  return samples;
}

/// A number that every run gives one of.
struct Statistic {
  std::vector<double> values;

  double mean() const {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
  }
  double standard_error() const {
    double sum = 0;
    for (const double value : values) sum += (value - mean()) * (value - mean());
    const auto n = static_cast<double>(values.size());
    return n > 1 ? std::sqrt(sum / (n * (n - 1))) : 0;
  }
};

void add(const std::string& name, const Statistic& statistic, const char* unit, BenchReport& report) {
  report.results.push_back({name, statistic.mean(), unit});
  report.results.push_back({absl::StrCat(name, ", standard error"), statistic.standard_error(), unit});
}

void add_discrepancies(const TriangleMesh& mesh, const SurfaceCurve& curve, const Elements& elements,
                       const AreasBenchOptions& options, const ExecutionContext& context, BenchReport& report) {
  const std::vector<double> sizes = ring_set_sizes(curve.size() / 10);
  const std::vector<float> density(curve.size(), 1.0f);
  std::array<Statistic, 3> rms, max, rms_gradient, max_gradient;  // rms and max: of the largest sets
  std::array<Statistic, 3> rms_ratio, max_ratio;                  // to the exact elements, with the same random numbers
  for (int run = 0; run < options.runs && !context.cancelled(); ++run) {
    context.progress("discrepancy", static_cast<double>(run) / options.runs);
    std::vector<std::vector<std::uint32_t>> sets;
    for (const Kind kind : {kExact, kVoronoi, kRandom}) {
      for (const double n : sizes) {
        const std::uint64_t seed = mix_bits(options.seed + static_cast<std::uint64_t>(run)) + static_cast<std::uint64_t>(n);
        sets.push_back(draw(kind, static_cast<std::size_t>(n), seed, curve, elements, density));
      }
    }
    const std::vector<Discrepancy> found = ring_discrepancy(mesh, sets, {.regions = options.regions, .seed = options.seed});
    std::array<std::vector<double>, 3> all_rms, all_max;
    for (std::size_t i = 0; i < found.size(); ++i) {
      all_rms[i / sizes.size()].push_back(found[i].rms);
      all_max[i / sizes.size()].push_back(found[i].max);
    }
    const auto mean_ratio = [&](const std::array<std::vector<double>, 3>& all, std::size_t kind) {
      double sum = 0;
      for (std::size_t i = 0; i < sizes.size(); ++i) sum += std::log(all[kind][i] / all[kExact][i]);
      return std::exp(sum / static_cast<double>(sizes.size()));
    };
    for (std::size_t kind = 0; kind < 3; ++kind) {
      rms[kind].values.push_back(all_rms[kind].back());
      max[kind].values.push_back(all_max[kind].back());
      rms_gradient[kind].values.push_back(log_log_gradient(sizes, all_rms[kind]));
      max_gradient[kind].values.push_back(log_log_gradient(sizes, all_max[kind]));
      rms_ratio[kind].values.push_back(mean_ratio(all_rms, kind));
      max_ratio[kind].values.push_back(mean_ratio(all_max, kind));
    }
  }
  for (std::size_t kind = 0; kind < 3; ++kind) {
    const std::string name = absl::StrCat(kNames[kind], ": ");
    const std::string largest = absl::StrFormat(", N = %.0f", sizes.back());
    add(absl::StrCat(name, "RMS", largest), rms[kind], "of 1", report);
    add(absl::StrCat(name, "maximum", largest), max[kind], "of 1", report);
    add(name + "RMS gradient", rms_gradient[kind], "power", report);
    add(name + "maximum gradient", max_gradient[kind], "power", report);
    if (kind == kExact) continue;
    add(name + "RMS, all N", rms_ratio[kind], "of exact", report);
    add(name + "maximum, all N", max_ratio[kind], "of exact", report);
  }
}

absl::StatusOr<BenchReport> run(const MeshFile& file, const AreasBenchOptions& options, const ExecutionContext& context) {
  const absl::StatusOr<Preprocessed> done = preprocess(file, {.points = options.points}, context);
  if (!done.ok()) return done.status();
  const SurfaceCurve& curve = *done->curve;
  const absl::StatusOr<Elements> elements = make_elements(*done->flattened, curve, options, context);
  if (!elements.ok()) return elements.status();
  BenchReport report{"areas", {}};
  report.results.push_back({"exact", elements->seconds[kExact], "s"});
  report.results.push_back({"Voronoi", elements->seconds[kVoronoi], "s", elements->seconds[kExact]});
  for (const Kind kind : {kExact, kVoronoi}) {
    report.results.push_back(
        {absl::StrCat(kNames[kind], ": error of the sum"), 100 * (elements->sum[kind] / curve.total_area - 1), "%"});
  }
  add_discrepancies(done->flattened->loaded.mesh, curve, *elements, options, context, report);
  if (absl::Status status = context.check(); !status.ok()) return status;
  report.notes = {
      absl::StrFormat("%s: %d faces, %d curve vertices; means of %d runs with other samples, over the same %d regions.",
                      file.name, done->report.mesh.faces, curve.size(), options.runs, options.regions),
      "Ring discrepancy of jittered samples, N = 2 ... a tenth of the curve's vertices; random samples are drawn with the exact "
      "elements. All N: geometric mean of the ratios to the exact elements, sample sets of equal random numbers."};
  return report;
}

}  // namespace

absl::StatusOr<BenchReport> bench_areas(const MeshFile& file, const AreasBenchOptions& options, const ExecutionContext& context) {
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  return arena.execute([&] { return run(file, options, context); });
}

}  // namespace curvecast::cli::bench
