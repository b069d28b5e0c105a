#include "client/bench/paper/figures.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "client/bench/paper/pictures.h"
#include "client/bench/paper/remesh_errors.h"
#include "client/bench/paper/square_discs.h"
#include "client/bench/scene/mesh_picture.h"
#include "client/cli/render_scene.h"
#include "core/render/png_file.h"
#include "core/render/stroke_text.h"

namespace curvecast::cli::bench {
namespace {

constexpr double kPictureCount = 40;  // about, for progress
constexpr char kCurvature[] = "curvature:kind=gauss";
constexpr double kRemeshShare = 0.6;             // of the vertices: the paper's figure 9
constexpr std::uint64_t kMostVertices = 15'000;  // of a mesh whose triangles can be told apart on a picture

SampleFlags sample_of(std::uint64_t points, const char* density = nullptr) {
  SampleFlags flags;
  flags.points = points;
  if (density != nullptr) flags.density = {density};
  return flags;
}

/// Where the camera of a density stands, left of the picture, and which way it looks.
void draw_arrow(Image& image) {
  constexpr Rgb8 kRed = {214, 40, 40};
  const double side = image.width;
  const Vec2d from(0.03 * side, 0.5 * side), to(0.15 * side, 0.5 * side), head(0.03 * side, 0.02 * side);
  const double width = std::max(1.5, 0.006 * side);
  draw_line(image, from, to, width, kRed);
  draw_line(image, to, to - head, width, kRed);
  draw_line(image, to, to - Vec2d(head.x(), -head.y()), width, kRed);
}

}  // namespace

absl::Status Figures::add(const char* figure, const std::string& caption, const absl::StatusOr<Image>& image) {
  if (!image.ok()) return image.status();
  absl::StatusOr<std::string> png = encode_png(*image);
  if (!png.ok()) return png.status();
  pictures_.push_back({figure, caption, *std::move(png)});
  context_.progress("pictures", std::min(1.0, static_cast<double>(pictures_.size()) / kPictureCount));
  return context_.check();
}

absl::Status Figures::draw_square(const HostedMesh& square, std::size_t points, std::vector<SquareDiscs>& squares) {
  const absl::StatusOr<v1::MeshInfo> info = square.info();
  if (!info.ok()) return info.status();
  absl::Status status = add("1", "uniform Hilbert curve, 1,024 vertices", Pictures(square, *info, side_).curve(1000));
  if (!status.ok()) return status;
  absl::StatusOr<std::vector<DiscsPicture>> discs = draw_square_discs(square, points, side_, context_);
  if (!discs.ok()) return discs.status();
  for (DiscsPicture& picture : *discs) {
    const SquareDiscs& found = squares.emplace_back(std::move(picture.numbers));
    const std::string caption =
        absl::StrFormat("%s: star discrepancy %.3g, %.1f %% covered", found.name, found.star_discrepancy, 100 * found.covered);
    if (status = add("6", caption, picture.image); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status Figures::draw_sphere(const HostedMesh& sphere) {
  constexpr double kDistance = 1.2;  // diagonals
  const absl::StatusOr<v1::MeshInfo> info = sphere.info();
  if (!info.ok()) return info.status();
  const Pictures pictures(sphere, *info, side_);
  const v1::Camera view = pictures.camera_along({0, 0, 1}, kDistance);
  for (const int degrees : {0, 45, 90}) {
    const double angle = degrees * std::numbers::pi / 180;
    const v1::Camera eye = pictures.camera_along({std::sin(angle), 0, std::cos(angle)}, kDistance);
    const std::string caption =
        absl::StrFormat("4,000 points by silhouette (view:s0=0.1), %d degrees beside the camera", degrees);
    absl::Status status = add("8", caption, pictures.dots(sample_of(4000, "view:s0=0.1"), eye, &view));
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status Figures::draw_stages(const HostedMesh& mesh, const TriangleMesh& original, const std::string& name) {
  const absl::StatusOr<v1::MeshInfo> info = mesh.info();
  if (!info.ok()) return info.status();
  const Pictures pictures(mesh, *info, side_);
  const absl::StatusOr<v1::Camera> eye = pictures.camera();
  if (!eye.ok()) return eye.status();
  const auto titled = [&](const char* what) { return absl::StrCat(name, ": ", what); };
  const v1::Camera view = pictures.camera_along({0, 0, 1}, 0.6);
  const auto level_of_detail = [&](const Vec3d& from) {
    return pictures.dots(sample_of(4000, "distance"), pictures.camera_along(from, 1.9), &view);
  };
  absl::Status status = add("1", titled("adaptive curve, denser by curvature"), pictures.curve(1500, "curvature"));
  if (!status.ok()) return status;
  status = add("2 a", titled("the mesh"), draw_wireframe(original, to_render_camera(*eye, Vec3d::Zero()), side_, side_));
  if (!status.ok()) return status;
  status = add("2 b", titled("parameterised; blue where spread out, red where squeezed together"), pictures.parameter_mesh());
  if (!status.ok()) return status;
  if (status = add("2 c", titled("adaptive curve in the square"), pictures.curve(1500)); !status.ok()) return status;
  if (status = add("2 d", titled("the same on the surface"), pictures.surface_curve(1500)); !status.ok()) return status;
  if (status = add("2 e", titled("1,500 points, uniform"), pictures.dots(sample_of(1500), *eye)); !status.ok()) return status;
  if (status = add("2 f", titled("15,000 splats"), pictures.splats(15'000)); !status.ok()) return status;
  status = add("7", titled("4,000 points, denser towards the camera, seen from there"), level_of_detail({0, 0, 1}));
  if (!status.ok()) return status;
  absl::StatusOr<Image> beside = level_of_detail({1, 0, 0});
  if (beside.ok()) draw_arrow(*beside);
  return add("7", titled("the same from the side; the arrow is the camera"), beside);
}

absl::Status Figures::draw_samplings(const HostedMesh& mesh, const std::string& name, const PaperMesh* paper) {
  const absl::StatusOr<v1::MeshInfo> info = mesh.info();
  if (!info.ok()) return info.status();
  const Pictures pictures(mesh, *info, side_);
  const absl::StatusOr<v1::Camera> eye = pictures.camera();
  if (!eye.ok()) return eye.status();
  const auto titled = [&](const char* what) { return absl::StrCat(name, ": ", what); };
  // The paper shows Igea in figure 3 and its Lion in figure 4; others are shown in the same way.
  const char* const figure = paper != nullptr && std::string_view(paper->name) == "Lion" ? "4" : "3";
  absl::Status status = add(figure, titled("2,000 points, uniform"), pictures.dots(sample_of(2000), *eye));
  if (!status.ok()) return status;
  status = add(figure, titled("2,000 points by Gaussian curvature"), pictures.dots(sample_of(2000, kCurvature), *eye));
  if (!status.ok()) return status;
  if (status = add(figure, titled("25,000 splats"), pictures.splats(25'000)); !status.ok()) return status;
  const auto share = static_cast<std::uint64_t>(std::lround(kRemeshShare * static_cast<double>(info->vertices())));
  for (const char* const density : {"uniform", "curvature:kind=max,exponent=0.5"}) {
    SampleFlags flags = sample_of(std::min(share, kMostVertices), density);
    flags.sampler = "progressive";
    const absl::StatusOr<client::Mesh> remeshed = mesh.remesh({}, flags);
    if (!remeshed.ok()) return remeshed.status();
    const std::string caption = absl::StrFormat("%s: remeshed, %d vertices, --density %s", name, flags.points, density);
    status = add("9", caption, draw_wireframe(to_triangle_mesh(*remeshed), to_render_camera(*eye, Vec3d::Zero()), side_, side_));
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

std::vector<Picture> Figures::take() {
  std::ranges::stable_sort(pictures_, {}, &Picture::figure);
  return std::move(pictures_);
}

}  // namespace curvecast::cli::bench
