#include "client/cli/parameter_picture.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace curvecast::cli {
namespace {

/// A square of two triangles whose lower side is glued to its upper one, at z = 0 and far from the origin.
client::ParameterMesh strip() {
  client::ParameterMesh mesh;
  client::ParameterDisc& disc = mesh.discs.emplace_back();
  disc.positions = {{100, 0, 0}, {101, 0, 0}, {101, 1, 0}, {100, 1, 0}};
  disc.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  disc.triangles = {{0, 1, 2}, {0, 2, 3}};
  disc.faces = {0, 1};
  disc.area_ratios = {1, 1};
  disc.border = {0, 1, 2, 3};
  disc.border_cuts = {1, 0, 1, 0};
  return mesh;
}

constexpr int kHeight = 100;
const RenderCamera kCamera{.eye = {100.5, 0.5, 3}, .target = {100.5, 0.5, 0}};

TEST(ParameterPicture, DotsLieOnTheLinesWithoutGaps) {
  const Vec3d origin(100, 0, 0);
  const LineDots dots = trace_cuts(strip(), kCamera, kHeight, origin);
  ASSERT_EQ(dots.positions.size(), dots.colors.size());
  for (std::size_t i = 0; i < dots.positions.size(); ++i) {
    const Vec3f& p = dots.positions[i];
    const bool on_cut = p.y() == 0 || p.y() == 1, on_border = p.x() == 0 || p.x() == 1;
    EXPECT_TRUE(on_cut || on_border);
    if (!on_border) {
      EXPECT_EQ(dots.colors[i], kCutColor);
    }
    if (!on_cut) {
      EXPECT_EQ(dots.colors[i], kBorderColor);
    }
    const double pixel = 2 * std::tan(15 * 3.14159265 / 180) * 3.2 / kHeight;
    if (i > 0 && dots.colors[i] == dots.colors[i - 1] && (p - dots.positions[i - 1]).norm() < 0.5f) {
      EXPECT_LT((p - dots.positions[i - 1]).norm(), pixel);
    }
  }
  // The side from x = 1 to 0 runs against the other one and is left out: it is drawn from the other side of the cut.
  EXPECT_TRUE(std::none_of(dots.positions.begin(), dots.positions.end(),
                           [](const Vec3f& p) { return p.y() == 1 && p.x() > 0.1f && p.x() < 0.9f; }));
}

TEST(ParameterPicture, LinesWithoutLengthAreDots) {
  client::ParameterMesh mesh = strip();
  for (auto& p : mesh.discs[0].positions) p = {1, 1, 1};
  EXPECT_EQ(trace_cuts(mesh, kCamera, kHeight, Vec3d::Zero()).positions.size(), 4u);
}

TEST(ParameterPicture, DrawsTheDiscs) {
  const auto picture = draw_uv(strip(), 120, 130);
  ASSERT_TRUE(picture.ok()) << picture.status();
  EXPECT_EQ(picture->image.height, 130);
  EXPECT_FALSE(draw_uv({}, 120, 130).ok());
}

}  // namespace
}  // namespace curvecast::cli
