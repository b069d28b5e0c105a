#include "core/flatten/flatten.h"

#include <absl/strings/str_format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/mutex.h"
#include "core/base/stopwatch.h"
#include "core/flatten/cut_to_disc.h"
#include "core/flatten/distortion.h"
#include "core/flatten/face_set.h"
#include "core/flatten/minimise_stretch.h"
#include "core/flatten/parameterise.h"
#include "core/flatten/parameterise_cgal.h"
#include "core/flatten/partition_faces.h"
#include "core/flatten/piece.h"
#include "core/mesh/topology.h"

namespace curvecast {
namespace {

using Faces = std::vector<std::uint32_t>;

// README.md says where these come from.
constexpr double kPartWork = 4e4;      // vertices in the sweeps of a level beyond the first, of a part of a large component
constexpr double kCornerPlay = 0.1;    // of a part's border: how far the square's corners go for where it turns
constexpr double kEvenStretch = 1.25;  // L2 stretch of a part up to which no cut is looked for
constexpr double kMostStretch = 2.5;   // from which on a component is divided into parts of at least kLeastPart faces
constexpr std::size_t kLeastPart = 1000;

bool is_valid(const Chart& chart, double max_area_ratio) {
  if (count_flipped(chart.disc, chart.uv) > 0) return false;
  const double most = max_area_ratio * surface_area(chart.disc);  // the square's area is 1
  for (std::size_t t = 0; t < chart.disc.face_count(); ++t) {
    const double ratio = area_ratio({chart.disc, chart.uv}, t);
    if (!(std::isfinite(ratio) && ratio <= most)) return false;
  }
  return true;
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

/// The faces of each component.
absl::StatusOr<std::vector<Faces>> list_components(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> component_of_face;
  const std::size_t count = label_components(mesh.twins, component_of_face);
  if (count > kMostComponents) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "the mesh falls into %d pieces that share no edge; at most %d are taken: join them, or leave out small ones", count,
        kMostComponents));
  }
  std::vector<Faces> components(count);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) components[component_of_face[f]].push_back(f);
  return components;
}

absl::StatusOr<std::vector<Vec2d>> map_to_square(const DiscMesh& disc, Parameterisation parameterisation,
                                                 const MinimiseStretchOptions& stretch, const ExecutionContext& context) {
  switch (parameterisation) {
    case Parameterisation::kLeastStretch:
      return minimise_stretch(disc, stretch, context);
    case Parameterisation::kCgal:
      return parameterise_cgal(disc, CgalPreconditioner::kIncompleteLu, nullptr, context);
    case Parameterisation::kMeanValue:
      return parameterise(disc, {.weights = ParameterWeights::kMeanValue}, context);
    case Parameterisation::kUniform:
      break;
  }
  return parameterise(disc, {.weights = ParameterWeights::kUniform}, context);
}

/// Splits of edges left room for twice as many in most arrays.
void give_back_slack(Chart& chart) {
  DiscMesh& disc = chart.disc;
  disc.positions.shrink_to_fit();
  disc.triangles.shrink_to_fit();
  disc.twins.shrink_to_fit();
  disc.face_of.shrink_to_fit();
  disc.border.shrink_to_fit();
  chart.uv.shrink_to_fit();
}

/// The chart of a disc by the first parameterisation that is valid; nullopt when none is.
std::optional<Chart> make_chart(DiscMesh disc, const FlattenOptions& options, const MinimiseStretchOptions& stretch,
                                const ExecutionContext& context) {
  const Parameterisation first =
      options.parameteriser == Parameteriser::kCgal ? Parameterisation::kCgal : Parameterisation::kLeastStretch;
  Chart chart{.disc = std::move(disc)};
  for (const Parameterisation parameterisation : {first, Parameterisation::kMeanValue, Parameterisation::kUniform}) {
    if (context.cancelled()) break;
    absl::StatusOr<std::vector<Vec2d>> uv = map_to_square(chart.disc, parameterisation, stretch, context);
    if (!uv.ok()) continue;
    chart.uv = *std::move(uv);
    chart.parameterisation = parameterisation;
    if (is_valid(chart, options.max_area_ratio)) return chart;
  }
  return std::nullopt;
}

/// Makes the border start where the square's corners (0, 0) and (1, 0), a quarter of the border apart, come nearest to where the
/// curve shall enter and leave.
void turn_border(DiscMesh& disc, const std::optional<Vec3d>& entry, const std::optional<Vec3d>& exit) {
  if (!entry && !exit) return;
  std::vector<std::uint32_t>& border = disc.border;
  const std::size_t n = border.size();
  std::vector<double> along(2 * n + 1, 0.0);  // twice around
  for (std::size_t i = 0; i < 2 * n; ++i) {
    along[i + 1] = along[i] + (disc.positions[border[(i + 1) % n]] - disc.positions[border[i % n]]).norm();
  }
  const auto away = [&](std::size_t i, const std::optional<Vec3d>& gate) {
    return gate ? (disc.positions[border[i % n]] - *gate).norm() : 0.0;
  };
  std::size_t best = 0, quarter = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < n; ++i) {
    while (along[quarter] < along[i] + along[n] / 4) ++quarter;
    if (const double sum = away(i, entry) + away(quarter, exit); sum < least) least = sum, best = i;
  }
  std::rotate(border.begin(), border.begin() + static_cast<std::ptrdiff_t>(best), border.end());
}

/// Flattens components one by one, several at a time.
class Flattener {
 public:
  Flattener(const TriangleMesh& mesh, const FlattenOptions& options, const ExecutionContext& context)
      : mesh_(mesh), options_(options), context_(context) {}

  /// The charts of one component; InternalError when a single triangle defeats all parameterisations.
  absl::StatusOr<std::vector<Chart>> flatten_component(Faces component) {
    if (component.size() <= options_.most_whole_faces) return flatten_part({std::move(component), {}, {}}, false);
    report("cut", 0);
    const std::size_t parts = (component.size() + options_.chart_faces - 1) / options_.chart_faces;
    return divide(std::move(component), parts);
  }

  /// Calls flatten(item) for all items, several at a time.
  template <typename Item, typename Flatten>
  static std::vector<absl::StatusOr<std::vector<Chart>>> for_each_alone(std::vector<Item>& items, const Flatten& flatten) {
    std::vector<absl::StatusOr<std::vector<Chart>>> flattened(items.size());
    tbb::parallel_for(std::size_t{0}, items.size(), [&](std::size_t i) {
      // A thread that waits within one item must not start on another: that would be counted, and held in memory, twice.
      tbb::this_task_arena::isolate([&] { flattened[i] = flatten(items[i]); });
    });
    return flattened;
  }

  /// Returns all charts, or the first error.
  static absl::StatusOr<std::vector<Chart>> join(std::vector<absl::StatusOr<std::vector<Chart>>> flattened) {
    std::vector<Chart> charts;
    for (absl::StatusOr<std::vector<Chart>>& some : flattened) {
      if (!some.ok()) return some.status();
      charts.insert(charts.end(), std::make_move_iterator(some->begin()), std::make_move_iterator(some->end()));
    }
    return charts;
  }

  /// Of all threads together.
  FlattenTimes times() const {
    const MutexLock lock(mutex_);
    return times_;
  }

 private:
  /// The charts of a part: one, or several where that fails or would stretch too much.
  /// `is_part`: of a component, not all of it.
  absl::StatusOr<std::vector<Chart>> flatten_part(FacePart part, bool is_part) {
    std::vector<Chart> charts;
    std::vector<Faces> pieces;  // taken from the back
    pieces.push_back(std::move(part.faces));
    while (!pieces.empty()) {
      if (absl::Status status = context_.check(); !status.ok()) return status;
      Faces faces = std::move(pieces.back());
      pieces.pop_back();
      std::size_t parts = 1;
      std::optional<Chart> chart = flatten_piece(faces, part, is_part ? nullptr : &parts);
      if (absl::Status status = context_.check(); !status.ok()) return status;
      if (chart) {
        charts.push_back(*std::move(chart));
      } else if (parts > 1) {
        absl::StatusOr<std::vector<Chart>> some = divide(std::move(faces), parts);
        if (!some.ok()) return some.status();
        charts.insert(charts.end(), std::make_move_iterator(some->begin()), std::make_move_iterator(some->end()));
      } else if (faces.size() == 1) {
        return absl::InternalError("a single triangle could not be parameterised");
      } else {
        std::vector<Faces> halves = bisect(mesh_, faces);
        pieces.insert(pieces.end(), std::make_move_iterator(halves.rbegin()), std::make_move_iterator(halves.rend()));
      }
    }
    return charts;
  }

  /// The charts of so many parts.
  absl::StatusOr<std::vector<Chart>> divide(Faces faces, std::size_t count) {
    std::vector<FacePart> parts = partition_faces(mesh_, faces, count, context_);
    if (absl::Status status = context_.check(); !status.ok()) return status;
    faces = {};
    return join(for_each_alone(parts, [&](FacePart& part) { return flatten_part(std::move(part), true); }));
  }

  /// The chart of a piece; nullopt where that fails, or where it would be stretched so much that it is better divided into
  /// `parts`: null where it is a part already.
  std::optional<Chart> flatten_piece(const Faces& faces, const FacePart& part, std::size_t* parts) {
    Stopwatch watch;
    const TriangleMesh piece = extract_piece(mesh_, faces);
    const bool is_part = parts == nullptr;
    MinimiseStretchOptions stretch;
    FlattenTimes seconds;
    std::optional<Chart> chart;
    const auto try_with = [&](std::span<const std::uint32_t> extremities) {
      if (!is_part) report("cut", 0);  // parts take turns: all of it counts as one stage
      absl::StatusOr<DiscMesh> disc = cut_to_disc(piece, extremities);
      if (disc.ok()) turn_border(*disc, part.entry, part.exit);
      seconds.cut += watch.lap();
      report("parameterise", 0);
      if (disc.ok()) chart = make_chart(*std::move(disc), options_, stretch, context_);
      seconds.parameterise += watch.lap();
    };
    if (is_part) {
      // As a rule parts of a large surface are flat enough without any cut: looking for one would take as long as the map.
      stretch.corner_play = kCornerPlay;
      stretch.work = kPartWork;
      try_with({});
      if (chart && measure_stretch(chart->disc, chart->uv).total > kEvenStretch) chart.reset();
    }
    if (!chart && !context_.cancelled()) {
      const Extremities extremities = find_extremities(piece, options_.extremities, context_);
      if (!is_part && extremities.stretch > kMostStretch) {
        const double wanted = std::min(extremities.stretch * extremities.stretch / 2, 1e9);
        *parts = std::min(static_cast<std::size_t>(wanted), faces.size() / kLeastPart);
        if (*parts > 1) return std::nullopt;
      }
      stretch.levels = extremities.levels;
      try_with(extremities.vertices);
    }
    if (chart) {
      for (std::uint32_t& f : chart->disc.face_of) f = faces[f];
      give_back_slack(*chart);
      report("parameterise", faces.size());
    }
    const MutexLock lock(mutex_);
    times_.cut += seconds.cut;
    times_.parameterise += seconds.parameterise;
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
  absl::StatusOr<std::vector<Faces>> components = list_components(mesh);
  if (!components.ok()) return components.status();
  if (absl::Status status = context.check(); !status.ok()) return status;
  Flattener flattener(mesh, options, context);
  absl::StatusOr<std::vector<Chart>> charts = Flattener::join(Flattener::for_each_alone(
      *components, [&](Faces& component) { return flattener.flatten_component(std::move(component)); }));
  if (!charts.ok()) return charts.status();
  // What each stage took of the time that has passed.
  const FlattenTimes all = flattener.times();
  const double scale = watch.lap() / std::max(all.cut + all.parameterise, 1e-9);
  times = {all.cut * scale, all.parameterise * scale};
  context.progress("parameterise", 1);
  return charts;
}

}  // namespace curvecast
