#include "client/cli/parameter_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curvecast::cli {
namespace {

constexpr double kDotsPerPixel = 2;
// Of the distance between two dots, in diagonals of the mesh: a close-up must not take all memory.
constexpr double kSmallestStep = 2e-5;

bool comes_first(const Vec3d& a, const Vec3d& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

}  // namespace

absl::StatusOr<UvPicture> draw_uv(const client::ParameterMesh& mesh, int width, int height) {
  std::vector<std::vector<Vec2d>> uv;
  std::vector<UvDisc> discs;
  uv.reserve(mesh.discs.size());
  for (const client::ParameterDisc& disc : mesh.discs) {
    std::vector<Vec2d>& places = uv.emplace_back();
    for (const auto& [u, v] : disc.uv) places.emplace_back(u, v);
    discs.push_back({places, disc.triangles, disc.area_ratios});
  }
  UvRenderOptions options;
  options.width = width;
  options.height = height;
  return render_uv(discs, options);
}

LineDots trace_cuts(const client::ParameterMesh& mesh, const RenderCamera& camera, int height, const Vec3d& origin) {
  Box3d box;
  for (const client::ParameterDisc& disc : mesh.discs) {
    for (const auto& p : disc.positions) box.extend(Vec3d(p.data()));
  }
  const double smallest = kSmallestStep * box.diagonal();
  const double pixel_at_one = 2 * std::tan(camera.vertical_fov_degrees * std::numbers::pi / 360) / height;
  LineDots dots;
  for (const client::ParameterDisc& disc : mesh.discs) {
    for (std::size_t i = 0; i < disc.border.size(); ++i) {
      const Vec3d a(disc.positions[disc.border[i]].data());
      const Vec3d b(disc.positions[disc.border[(i + 1) % disc.border.size()]].data());
      const bool is_cut = disc.border_cuts[i] != 0;
      if (is_cut && comes_first(b, a)) continue;  // the other side draws it
      const double length = (b - a).norm();
      for (double along = 0; along <= length;) {
        const Vec3d p = length > 0 ? Vec3d(a + (b - a) * (along / length)) : a;
        dots.positions.push_back((p - origin).cast<float>());
        dots.colors.push_back(is_cut ? kCutColor : kBorderColor);
        const double step = std::max(pixel_at_one * (p - camera.eye).norm() / kDotsPerPixel, smallest);
        if (!(step > 0)) break;
        along += step;
      }
    }
  }
  return dots;
}

}  // namespace curvecast::cli
