#include "client/cli/parameter_picture.h"

#include <gtest/gtest.h>

#include "tests/client/strip_mesh.h"

namespace curvecast::cli {
namespace {

TEST(ParameterPicture, DrawsTheDiscs) {
  const auto picture = draw_uv(strip(), 120, 130);
  ASSERT_TRUE(picture.ok()) << picture.status();
  EXPECT_EQ(picture->image.height, 130);
  EXPECT_FALSE(draw_uv({}, 120, 130).ok());
}

/// A disc of four quads, `scale` times as large as the unit square.
client::CurveDisc four_quads(float scale) {
  client::CurveDisc disc;
  disc.positions = {{0, 0, 0}, {0, scale, 0}, {scale, scale, 0}, {scale, 0, 0}};
  disc.normals.assign(4, {0, 0, 32767});
  disc.areas.assign(4, scale * scale / 4);
  disc.cells = {{0, 0}, {0, 1u << 29}, {1u << 29, 1u << 29}, {1u << 29, 0}};
  disc.levels.assign(4, 1);
  return disc;
}

/// The number of pixels that are not white, from column `from` to `to`.
int ink(const Image& image, int from, int to) {
  int sum = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = from; x < to; ++x) sum += image.rgba[4 * (static_cast<std::size_t>(y) * image.width + x) + 1] != 255;
  }
  return sum;
}

TEST(ParameterPicture, DrawsCurvesTheLargestDiscFirst) {
  client::Curve curve;
  curve.discs = {four_quads(1), four_quads(3)};
  curve.discs[1].positions.resize(1);  // not what is drawn
  curve.discs[1].cells.resize(1);
  curve.discs[1].levels = {0};
  const auto picture = draw_curve(curve, nullptr, 200, 100);
  ASSERT_TRUE(picture.ok()) << picture.status();
  EXPECT_EQ(picture->tiles, 2);
  // The larger surface has one vertex: a frame, and no line in it.
  EXPECT_GT(ink(picture->image, 100, 200), ink(picture->image, 0, 100) + 50);
}

TEST(ParameterPicture, DrawsAMeshBehindItsCurve) {
  client::Curve curve;
  curve.discs = {four_quads(1)};
  const client::ParameterMesh mesh = strip();
  const auto alone = draw_curve(curve, nullptr, 128, 128), both = draw_curve(curve, &mesh, 128, 128);
  ASSERT_TRUE(alone.ok() && both.ok());
  EXPECT_GT(ink(both->image, 0, 128), ink(alone->image, 0, 128) + 50);
  curve.discs.push_back(four_quads(1));
  EXPECT_FALSE(draw_curve(curve, &mesh, 128, 128).ok());
  EXPECT_FALSE(draw_curve({}, nullptr, 128, 128).ok());
}

}  // namespace
}  // namespace curvecast::cli
