#include "core/flatten/flatten.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "core/base/mutex.h"
#include "core/base/stopwatch.h"
#include "core/flatten/cut_to_disc.h"
#include "core/flatten/distortion.h"
#include "core/flatten/face_set.h"
#include "core/flatten/minimise_stretch.h"
#include "core/flatten/parameterise.h"
#include "core/flatten/parameterise_cgal.h"
#include "core/flatten/piece.h"
#include "core/mesh/topology.h"

namespace curvecast {
namespace {

using Faces = std::vector<std::uint32_t>;

bool is_valid(const Chart& chart, double max_area_ratio) {
  if (count_flipped(chart.disc, chart.uv) > 0) return false;
  const double largest = *std::max_element(chart.area_ratio.begin(), chart.area_ratio.end());
  return std::isfinite(largest) && largest <= max_area_ratio * surface_area(chart.disc);  // the square's area is 1
}

/// Divides the faces into the half nearest to the first one, by steps between neighbours, and the connected rest.
std::vector<Faces> bisect(const TriangleMesh& mesh, const Faces& faces) {
  const FaceSet set(faces, mesh);
  std::vector<bool> taken(faces.size(), false);
  const auto grow = [&](std::uint32_t seed, std::size_t limit) {
    Faces part = {faces[seed]};
    taken[seed] = true;
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (std::uint32_t h = 3 * part[i]; h < 3 * part[i] + 3 && part.size() < limit; ++h) {
        const std::uint32_t twin = mesh.twins[h];
        const std::uint32_t next = twin == kNone ? kNone : set.index(twin / 3);
        if (next == kNone || taken[next]) continue;
        taken[next] = true;
        part.push_back(faces[next]);
      }
    }
    std::sort(part.begin(), part.end());
    return part;
  };
  std::vector<Faces> parts = {grow(0, (faces.size() + 1) / 2)};
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    if (!taken[i]) parts.push_back(grow(i, faces.size()));
  }
  return parts;
}

absl::StatusOr<std::vector<Vec2d>> map_to_square(const DiscMesh& disc, Parameterisation parameterisation,
                                                 const ExecutionContext& context) {
  switch (parameterisation) {
    case Parameterisation::kLeastStretch:
      return minimise_stretch(disc, {}, context);
    case Parameterisation::kCgal:
      return parameterise_cgal(disc);
    case Parameterisation::kMeanValue:
      return parameterise(disc, {.weights = ParameterWeights::kMeanValue});
    case Parameterisation::kUniform:
      break;
  }
  return parameterise(disc, {.weights = ParameterWeights::kUniform});
}

/// The chart of a disc by the first parameterisation that is valid; nullopt when none is.
std::optional<Chart> make_chart(DiscMesh disc, const FlattenOptions& options, const ExecutionContext& context) {
  const Parameterisation first =
      options.parameteriser == Parameteriser::kCgal ? Parameterisation::kCgal : Parameterisation::kLeastStretch;
  Chart chart{.disc = std::move(disc)};
  for (const Parameterisation parameterisation : {first, Parameterisation::kMeanValue, Parameterisation::kUniform}) {
    if (context.cancelled()) break;
    absl::StatusOr<std::vector<Vec2d>> uv = map_to_square(chart.disc, parameterisation, context);
    if (!uv.ok()) continue;
    chart.uv = *std::move(uv);
    chart.area_ratio = area_ratios(chart.disc, chart.uv);
    chart.parameterisation = parameterisation;
    if (is_valid(chart, options.max_area_ratio)) return chart;
  }
  return std::nullopt;
}

/// Flattens components one by one, several at a time.
class Flattener {
 public:
  Flattener(const TriangleMesh& mesh, const FlattenOptions& options, const ExecutionContext& context)
      : mesh_(mesh), options_(options), context_(context) {}

  /// The charts of one component; InternalError when a single triangle defeats all parameterisations.
  absl::StatusOr<std::vector<Chart>> flatten_component(Faces component) {
    std::vector<Chart> charts;
    std::vector<Faces> pieces;  // taken from the back
    pieces.push_back(std::move(component));
    while (!pieces.empty()) {
      const Faces faces = std::move(pieces.back());
      pieces.pop_back();
      std::optional<Chart> chart = flatten_piece(faces);
      if (absl::Status status = context_.check(); !status.ok()) return status;
      if (chart) {
        charts.push_back(*std::move(chart));
      } else if (faces.size() == 1) {
        return absl::InternalError("a single triangle could not be parameterised");
      } else {
        std::vector<Faces> parts = bisect(mesh_, faces);
        pieces.insert(pieces.end(), std::make_move_iterator(parts.rbegin()), std::make_move_iterator(parts.rend()));
      }
    }
    return charts;
  }

  /// Of all threads together.
  FlattenTimes times() const {
    const MutexLock lock(mutex_);
    return times_;
  }

 private:
  std::optional<Chart> flatten_piece(const Faces& faces) {
    Stopwatch watch;
    report("cut", 0);
    const TriangleMesh piece = extract_piece(mesh_, faces);
    absl::StatusOr<DiscMesh> disc = cut_to_disc(piece, find_extremities(piece, options_.extremities, context_));
    const double cut = watch.lap();
    report("parameterise", 0);
    std::optional<Chart> chart;
    if (disc.ok()) chart = make_chart(*std::move(disc), options_, context_);
    if (chart) {
      for (std::uint32_t& f : chart->disc.face_of) f = faces[f];
      report("parameterise", faces.size());
    }
    const MutexLock lock(mutex_);
    times_.cut += cut;
    times_.parameterise += watch.lap();
    return chart;
  }

  void report(std::string_view stage, std::size_t faces) {
    const MutexLock lock(mutex_);
    faces_done_ += faces;
    context_.progress(stage, static_cast<double>(faces_done_) / static_cast<double>(mesh_.face_count()));
  }

  const TriangleMesh& mesh_;
  const FlattenOptions& options_;
  const ExecutionContext& context_;
  mutable Mutex mutex_;
  FlattenTimes times_ ABSL_GUARDED_BY(mutex_);
  std::size_t faces_done_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace

absl::StatusOr<std::vector<Chart>> flatten(const TriangleMesh& mesh, const FlattenOptions& options,
                                           const ExecutionContext& context, FlattenTimes& times) {
  Stopwatch watch;
  std::vector<std::uint32_t> component_of_face;
  std::vector<Faces> components(label_components(mesh.twins, component_of_face));
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) components[component_of_face[f]].push_back(f);
  Flattener flattener(mesh, options, context);
  std::vector<absl::StatusOr<std::vector<Chart>>> flattened(components.size());
  tbb::parallel_for(std::size_t{0}, components.size(), [&](std::size_t c) {
    // A thread that waits within a component must not start on another one: that would be counted, and held in memory, twice.
    tbb::this_task_arena::isolate([&] { flattened[c] = flattener.flatten_component(std::move(components[c])); });
  });
  std::vector<Chart> charts;
  for (absl::StatusOr<std::vector<Chart>>& of_component : flattened) {
    if (!of_component.ok()) return of_component.status();
    charts.insert(charts.end(), std::make_move_iterator(of_component->begin()), std::make_move_iterator(of_component->end()));
  }
  // What each stage took of the time that has passed.
  const FlattenTimes all = flattener.times();
  const double scale = watch.lap() / std::max(all.cut + all.parameterise, 1e-9);
  times = {all.cut * scale, all.parameterise * scale};
  context.progress("parameterise", 1);
  return charts;
}

}  // namespace curvecast
