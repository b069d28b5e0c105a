#include "core/flatten/flatten.h"

#include <algorithm>
#include <cmath>

#include "core/flatten/distortion.h"
#include "core/flatten/parameterise.h"
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
    const Triangle& v = chart.disc.triangles[t];
    const Vec2d p = chart.uv[v[1]] - chart.uv[v[0]];
    const Vec2d q = chart.uv[v[2]] - chart.uv[v[0]];
    surface += 0.5 * chart.area_ratio[t] * (p.x() * q.y() - p.y() * q.x());
    largest = std::max(largest, chart.area_ratio[t]);
  }
  return std::isfinite(largest) && largest <= max_area_ratio * surface;  // the square's area is 1
}

/// Divides the faces into the half nearest to the first one, by steps between neighbours, and the connected rest.
std::vector<Faces> bisect(const TriangleMesh& mesh, const Faces& faces) {
  constexpr char kOutside = 0, kUnseen = 1, kNear = 2, kDone = 3;
  std::vector<char> state(mesh.face_count(), kOutside);
  for (const std::uint32_t f : faces) state[f] = kUnseen;
  const auto grow = [&](std::uint32_t seed, std::size_t limit, char mark) {
    Faces part = {seed};
    state[seed] = mark;
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (std::uint32_t h = 3 * part[i]; h < 3 * part[i] + 3 && part.size() < limit; ++h) {
        const std::uint32_t twin = mesh.twins[h];
        if (twin == kNone || state[twin / 3] != kUnseen) continue;
        state[twin / 3] = mark;
        part.push_back(twin / 3);
      }
    }
    std::sort(part.begin(), part.end());
    return part;
  };
  std::vector<Faces> parts = {grow(faces.front(), (faces.size() + 1) / 2, kNear)};
  for (const std::uint32_t f : faces) {
    if (state[f] == kUnseen) parts.push_back(grow(f, faces.size(), kDone));
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
        absl::StatusOr<std::vector<Vec2d>> uv = parameterise(chart.disc, {.weights = weights});
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
