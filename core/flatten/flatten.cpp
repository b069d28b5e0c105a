#include "core/flatten/flatten.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/flatten/cut_to_disc.h"
#include "core/flatten/distortion.h"
#include "core/flatten/face_set.h"
#include "core/flatten/minimise_stretch.h"
#include "core/flatten/parameterise.h"
#include "core/flatten/parameterise_cgal.h"
#include "core/flatten/piece.h"
#include "core/mesh/topology.h"
#include "core/stopwatch.h"

namespace curvecast {
namespace {

using Faces = std::vector<std::uint32_t>;

bool is_valid(const Chart& chart, double max_area_ratio) {
  if (count_flipped(chart.disc, chart.uv) > 0) return false;
  double surface = 0;
  double largest = 0;
  for (std::size_t t = 0; t < chart.area_ratio.size(); ++t) {
    surface += chart.area_ratio[t] * uv_area(chart.disc, chart.uv, t);
    largest = std::max(largest, chart.area_ratio[t]);
  }
  return std::isfinite(largest) && largest <= max_area_ratio * surface;  // the square's area is 1
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
    absl::StatusOr<std::vector<Vec2d>> uv = map_to_square(chart.disc, parameterisation, context);
    if (!uv.ok()) continue;
    chart.uv = *std::move(uv);
    chart.area_ratio = area_ratios(chart.disc, chart.uv);
    chart.parameterisation = parameterisation;
    if (is_valid(chart, options.max_area_ratio)) return chart;
  }
  return std::nullopt;
}

}  // namespace

absl::StatusOr<std::vector<Chart>> flatten(const TriangleMesh& mesh, const FlattenOptions& options,
                                           const ExecutionContext& context, FlattenTimes& times) {
  std::vector<std::uint32_t> component_of_face;
  std::vector<Faces> pieces(label_components(mesh.twins, component_of_face));
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) pieces[component_of_face[f]].push_back(f);
  std::reverse(pieces.begin(), pieces.end());  // taken from the back
  std::vector<Chart> charts;
  std::size_t faces_done = 0;
  while (!pieces.empty()) {
    const Faces faces = std::move(pieces.back());
    pieces.pop_back();
    const double fraction = static_cast<double>(faces_done) / static_cast<double>(mesh.face_count());
    context.progress("cut", fraction);
    Stopwatch watch;
    const TriangleMesh piece = extract_piece(mesh, faces);
    absl::StatusOr<DiscMesh> disc = cut_to_disc(piece, find_extremities(piece, options.extremities, context));
    times.cut += watch.lap();
    context.progress("parameterise", fraction);
    std::optional<Chart> chart;
    if (disc.ok()) chart = make_chart(*std::move(disc), options, context);
    times.parameterise += watch.lap();
    if (absl::Status status = context.check(); !status.ok()) return status;
    if (chart) {
      for (std::uint32_t& f : chart->disc.face_of) f = faces[f];
      charts.push_back(*std::move(chart));
      faces_done += faces.size();
    } else if (faces.size() == 1) {
      return absl::InternalError("a single triangle could not be parameterised");
    } else {
      std::vector<Faces> parts = bisect(mesh, faces);
      pieces.insert(pieces.end(), std::make_move_iterator(parts.rbegin()), std::make_move_iterator(parts.rend()));
    }
  }
  context.progress("parameterise", 1);
  return charts;
}

}  // namespace curvecast
