#include "core/flatten/flatten.h"

#include <algorithm>
#include <cmath>

#include "core/flatten/distortion.h"
#include "core/flatten/face_set.h"
#include "core/flatten/parameterise.h"
#include "core/flatten/parameterise_cgal.h"
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
    if (absl::Status status = context.check(); !status.ok()) return status;
    const Faces faces = std::move(pieces.back());
    pieces.pop_back();
    const double fraction = static_cast<double>(faces_done) / static_cast<double>(mesh.face_count());
    context.progress("cut", fraction);
    Stopwatch watch;
    absl::StatusOr<DiscMesh> disc = cut_to_disc(mesh, faces, options.cut);
    times.cut += watch.lap();
    context.progress("parameterise", fraction);
    bool valid = false;
    if (disc.ok()) {
      Chart chart;
      chart.disc = *std::move(disc);
      for (const ParameterWeights weights : {ParameterWeights::kMeanValue, ParameterWeights::kUniform}) {
        const bool by_cgal = options.parameteriser == Parameteriser::kCgal && weights == ParameterWeights::kMeanValue;
        absl::StatusOr<std::vector<Vec2d>> uv =
            by_cgal ? parameterise_cgal(chart.disc) : parameterise(chart.disc, {.weights = weights});
        if (!uv.ok()) continue;
        chart.uv = *std::move(uv);
        chart.area_ratio = area_ratios(chart.disc, chart.uv);
        valid = is_valid(chart, options.max_area_ratio);
        if (valid) break;
      }
      if (valid) charts.push_back(std::move(chart));
    }
    times.parameterise += watch.lap();
    if (valid) {
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
