#include "client/cli/parameter_picture.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/render/curve_renderer.h"

namespace curvecast::cli {
namespace {

std::vector<Vec2d> uv_of(const client::ParameterDisc& disc) {
  std::vector<Vec2d> places;
  places.reserve(disc.uv.size());
  for (const auto& [u, v] : disc.uv) places.emplace_back(u, v);
  return places;
}

}  // namespace

absl::StatusOr<UvPicture> draw_uv(const client::ParameterMesh& mesh, int width, int height) {
  std::vector<std::vector<Vec2d>> uv;
  std::vector<UvDisc> discs;
  uv.reserve(mesh.discs.size());
  for (const client::ParameterDisc& disc : mesh.discs) {
    discs.push_back({uv.emplace_back(uv_of(disc)), disc.triangles, disc.area_ratios});
  }
  UvRenderOptions options;
  options.width = width;
  options.height = height;
  return render_uv(discs, options);
}

absl::StatusOr<CurvePicture> draw_curve(const client::Curve& curve, const client::ParameterMesh* mesh, int width, int height) {
  if (mesh != nullptr && mesh->discs.size() != curve.discs.size()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("the parameter mesh has %d discs, the curve %d", mesh->discs.size(), curve.discs.size()));
  }
  std::vector<double> surface(curve.discs.size());
  for (std::size_t d = 0; d < surface.size(); ++d) {
    surface[d] = std::accumulate(curve.discs[d].areas.begin(), curve.discs[d].areas.end(), 0.0);
  }
  std::vector<std::size_t> order(curve.discs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return surface[a] > surface[b]; });
  order.resize(std::min(order.size(), static_cast<std::size_t>(UvRenderOptions().max_tiles)));

  struct Columns {
    std::vector<Vec2d> points, uv;
    std::vector<double> sides;
  };
  std::vector<Columns> columns(order.size());
  std::vector<CurvePath> paths;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const client::CurveDisc& disc = curve.discs[order[i]];
    Columns& own = columns[i];
    for (std::size_t l = 0; l < disc.size(); ++l) {
      own.points.emplace_back(disc.centre(l)[0], disc.centre(l)[1]);
      own.sides.push_back(disc.side(l));
    }
    CurvePath& path = paths.emplace_back(CurvePath{own.points, own.sides, {}, {}});
    if (mesh == nullptr) continue;
    own.uv = uv_of(mesh->discs[order[i]]);
    path.uv = own.uv;
    path.triangles = mesh->discs[order[i]].triangles;
  }
  CurveRenderOptions options;
  options.width = width;
  options.height = height;
  absl::StatusOr<Image> image = render_curves(paths, options);
  if (!image.ok()) return image.status();
  return CurvePicture{*std::move(image), static_cast<int>(paths.size())};
}

}  // namespace curvecast::cli
