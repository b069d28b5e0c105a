#include "client/bench/neighbours_bench.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>
#include <numbers>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "client/bench/median.h"
#include "core/base/random.h"
#include "core/base/stopwatch.h"
#include "core/measure/neighbours.h"
#include "core/pipeline/pipeline.h"
#include "core/sample/resample.h"

namespace curvecast::cli::bench {
namespace {

constexpr double kHits = 16;  // of a radius query on average
constexpr std::size_t kNeighbours[] = {1, 8, 16};

/// Points as nanoflann wants them.
struct Cloud {
  PointView points;

  std::size_t kdtree_get_point_count() const { return points.size; }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return (axis == 0 ? points.x : axis == 1 ? points.y : points.z)[i * points.stride];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using KdTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, std::uint32_t>;

std::vector<Vec3f> to_vectors(const PointView& points) {
  std::vector<Vec3f> result;
  result.reserve(points.size);
  const Cloud cloud{points};
  for (std::size_t i = 0; i < points.size; ++i) {
    result.emplace_back(cloud.kdtree_get_pt(i, 0), cloud.kdtree_get_pt(i, 1), cloud.kdtree_get_pt(i, 2));
  }
  return result;
}

/// Medians of two ways to do the same, taken in turns so that a busy machine slows both.
struct Times {
  double ours = 0, theirs = 0;
};
template <typename Ours, typename Theirs>
Times compare(int repeats, Ours&& ours, Theirs&& theirs) {
  std::vector<double> mine, others;
  Stopwatch watch;
  for (int i = 0; i < repeats; ++i) {
    ours();
    mine.push_back(watch.lap());
    theirs();
    others.push_back(watch.lap());
  }
  return {median(std::move(mine)), median(std::move(others))};
}

/// One set of points, in one report.
class SetBench {
 public:
  SetBench(std::string name, const PointView& points, float spacing, int repeats, BenchReport& report)
      : name_(std::move(name)), points_(points), at_(to_vectors(points)), repeats_(repeats), report_(report) {
    places_ = at_;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        places_[i][axis] += spacing * static_cast<float>(2 * random_unit(1, 3 * i + static_cast<std::size_t>(axis)) - 1);
      }
    }
    radius_ = spacing * static_cast<float>(std::sqrt(kHits / std::numbers::pi));
  }

  void run() {
    const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    tbb::task_arena(1).execute([&] {
      build();
      for (const std::size_t k : kNeighbours) all_nearest(k, "");
      for (const std::size_t k : kNeighbours) nearest_of_places(k);
      within_radius();
    });
    if (cores > 1) {
      tbb::task_arena(cores).execute([&] {
        build_ = compare(
            repeats_, [&] { tree_ = NeighbourTree(points_); }, [] {});
        build_.theirs = kd_tree_build_;
        for (const std::size_t k : kNeighbours) all_nearest(k, absl::StrCat(", ", cores, " threads"));
      });
    }
    report_.results.push_back({absl::StrCat(name_, ": answers that differ"), static_cast<double>(different_), "count"});
  }

 private:
  void add(const std::string& what, const Times& times) {
    report_.results.push_back({absl::StrCat(name_, ": ", what), times.ours * 1e3, "ms", times.theirs * 1e3});
  }

  void build() {
    build_ = compare(
        repeats_, [&] { tree_ = NeighbourTree(points_); },
        [&] {
          kd_tree_.emplace(3, cloud_);
          kd_tree_->buildIndex();
        });
    kd_tree_build_ = build_.theirs;
    add("build", build_);
  }

  /// nanoflann finds the point itself first, and so is asked for one more.
  void all_nearest(std::size_t k, const std::string& threads) {
    std::vector<Neighbour> found(points_.size * k);
    std::vector<float> squares(points_.size * (k + 1));
    const Times times = compare(
        repeats_, [&] { tree_.all_nearest(k, found); },
        [&] {
          tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points_.size, 1024), [&](const auto& range) {
            std::vector<std::uint32_t> indices(k + 1);
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
              kd_tree_->knnSearch(at_[i].data(), k + 1, indices.data(), &squares[i * (k + 1)]);
            }
          });
        });
    const std::size_t others = points_.size - 1;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (i % k < others) different_ += found[i].square != squares[i / k * (k + 1) + i % k + 1];
    }
    add(absl::StrFormat("%d nearest of all%s", k, threads), times);
    add(absl::StrFormat("build + %d nearest of all%s", k, threads), {build_.ours + times.ours, build_.theirs + times.theirs});
  }

  void nearest_of_places(std::size_t k) {
    std::vector<Neighbour> found(places_.size() * k);
    std::vector<float> squares(places_.size() * k);
    std::vector<std::uint32_t> indices(k);
    const Times times = compare(
        repeats_,
        [&] {
          for (std::size_t i = 0; i < places_.size(); ++i) tree_.nearest(places_[i], std::span(found).subspan(i * k, k));
        },
        [&] {
          for (std::size_t i = 0; i < places_.size(); ++i) {
            kd_tree_->knnSearch(places_[i].data(), k, indices.data(), &squares[i * k]);
          }
        });
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (i % k < points_.size) different_ += found[i].square != squares[i];
    }
    add(absl::StrFormat("%d nearest of places one by one", k), times);
    add(absl::StrFormat("build + %d nearest of places", k), {build_.ours + times.ours, build_.theirs + times.theirs});
  }

  void within_radius() {
    std::vector<Neighbour> found;
    std::vector<std::pair<std::uint32_t, float>> theirs;
    const nanoflann::SearchParams unsorted(32, 0, false);
    std::size_t hits = 0, their_hits = 0;
    const float limit = radius_ * radius_;
    const Times times = compare(
        repeats_,
        [&] {
          hits = 0;
          for (const Vec3f& p : at_) {
            tree_.within(p, radius_, found);
            hits += found.size();
          }
        },
        [&] {
          their_hits = 0;
          for (const Vec3f& p : at_) {
            // It leaves out what lies at the radius itself.
            kd_tree_->radiusSearch(p.data(), std::nextafter(limit, 2 * limit), theirs, unsorted);
            their_hits += theirs.size();
          }
        });
    different_ += hits > their_hits ? hits - their_hits : their_hits - hits;
    add("within a radius one by one", times);
    report_.results.push_back({absl::StrCat(name_, ": hits of a radius"),
                               static_cast<double>(hits) / static_cast<double>(std::max<std::size_t>(1, points_.size)),
                               "points"});
  }

  std::string name_;
  PointView points_;
  std::vector<Vec3f> at_, places_;  // the points, and places about a point's distance from them
  float radius_ = 0;
  int repeats_;
  BenchReport& report_;
  Cloud cloud_{points_};
  NeighbourTree tree_;
  std::optional<KdTree> kd_tree_;
  Times build_;
  double kd_tree_build_ = 0;
  std::size_t different_ = 0;
};

}  // namespace

absl::StatusOr<BenchReport> bench_neighbours(const MeshFile& file, const NeighboursBenchOptions& options,
                                             const ExecutionContext& context) {
  const absl::StatusOr<Preprocessed> made = preprocess(file, {.points = options.points}, context);
  if (!made.ok()) return made.status();
  const SurfaceCurve& curve = *made->curve;
  const absl::StatusOr<PointSet> samples = resample(curve, {.points = options.samples, .seed = options.seed});
  if (!samples.ok()) return samples.status();
  BenchReport report{"neighbours", {}};
  const auto spacing = [&](std::size_t n) { return static_cast<float>(std::sqrt(curve.total_area / static_cast<double>(n))); };
  context.progress("curve vertices", 0);
  SetBench("curve", view_of(curve.x, curve.y, curve.z), spacing(curve.size()), options.repeats, report).run();
  context.progress("samples", 0.5);
  SetBench("samples", view_of(samples->positions), spacing(samples->size()), options.repeats, report).run();
  context.progress("samples", 1);
  report.notes = {
      absl::StrFormat(
          "%s: %d curve vertices of a curve for %d points and %d samples; medians of %d, ours and nanoflann's (leaves "
          "of 10) in turns; one thread where nothing else is said.",
          file.name, curve.size(), options.points, samples->size(), options.repeats),
      "Places one by one lie about as far from the points as these from one another; nanoflann is asked for k + 1 nearest of "
      "all, "
      "as it finds the point itself, and builds with one thread always."};
  return report;
}

}  // namespace curvecast::cli::bench
