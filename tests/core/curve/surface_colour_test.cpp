#include "core/curve/surface_colour.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "tests/support/shapes.h"

namespace curvecast {
namespace {

constexpr Rgba8 kRed = {255, 0, 0, 255}, kGreen = {0, 255, 0, 255}, kBlue = {0, 0, 255, 255}, kGrey = {90, 90, 90, 255};

std::shared_ptr<const Image> image_of(int width, int height, const std::vector<Rgba8>& texels) {
  Image image{width, height, {}};
  for (const Rgba8& t : texels) image.rgba.insert(image.rgba.end(), {t.r, t.g, t.b, t.a});
  return std::make_shared<const Image>(std::move(image));
}

std::shared_ptr<const Image> checkers(int side) {
  std::vector<Rgba8> texels;
  for (int i = 0; i < side * side; ++i) texels.push_back((i / side + i) % 2 == 0 ? Rgba8{} : Rgba8{0, 0, 0, 255});
  return image_of(side, side, texels);
}

/// The unit square as two triangles, whose texture coordinates are x and y times `repeat`.
struct Square {
  TriangleMesh mesh = testing::make_mesh(
      testing::soup_of({Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(1, 1, 0), Vec3d(0, 1, 0)}, {{0, 1, 2}, {0, 2, 3}}));
  MeshAttributes attributes;

  void put_texture(std::shared_ptr<const Image> texture, float repeat = 1, const Rgba8& colour = {}) {
    attributes.materials = {{"m", colour, std::move(texture)}};
    attributes.material_of_face.assign(2, 0);
    attributes.uv.clear();
    for (const Triangle& t : mesh.triangles) {
      for (const std::uint32_t v : t) attributes.uv.push_back(repeat * mesh.positions[v].head<2>().cast<float>());
    }
  }

  Rgba8 at(double x, double y, double area = 0) const {
    // Above the diagonal is the triangle 0 2 3, under it 0 1 2.
    const bool above = y > x;
    const Vec3f weights = (above ? Vec3d(1 - y, x, y - x) : Vec3d(1 - x, x - y, y)).cast<float>();
    return SurfaceColour(mesh, attributes).at(above ? 1 : 0, weights, area);
  }
};

void expect_near(const Rgba8& a, const Rgba8& b, int tolerance) {
  EXPECT_NEAR(a.r, b.r, tolerance);
  EXPECT_NEAR(a.g, b.g, tolerance);
  EXPECT_NEAR(a.b, b.b, tolerance);
  EXPECT_NEAR(a.a, b.a, tolerance);
}

TEST(SurfaceColour, ATextureStandsUpright) {
  Square square;
  square.put_texture(image_of(2, 2, {kRed, kGreen, kBlue, kGrey}));  // from top to bottom
  EXPECT_EQ(square.at(0.25, 0.75), kRed);
  EXPECT_EQ(square.at(0.75, 0.75), kGreen);
  EXPECT_EQ(square.at(0.25, 0.25), kBlue);
  EXPECT_EQ(square.at(0.75, 0.25), kGrey);
}

TEST(SurfaceColour, BetweenTexelsLightIsMixed) {
  Square square;
  square.put_texture(image_of(2, 1, {kRed, kGreen}));
  const Rgba8 half = {180, 180, 0, 255};  // half the light is 0.7 of the number
  expect_near(square.at(0.5, 0.3), half, 1);
  expect_near(square.at(0, 0.3), half, 1);  // around the edge
  expect_near(square.at(1, 0.6), half, 1);
}

TEST(SurfaceColour, TexturesRepeat) {
  Square square;
  const auto texture = image_of(2, 2, {kRed, kGreen, kBlue, kGrey});
  square.put_texture(texture, 3);
  for (const double x : {0.0, 1.0 / 3, 2.0 / 3}) {
    expect_near(square.at(x + 0.25 / 3, 0.75 / 3), kRed, 1);
    expect_near(square.at(x + 0.25 / 3, 0.25 / 3), kBlue, 1);
  }
  square.put_texture(texture);
  const Rgba8 here = square.at(0.4, 0.7);
  for (Vec2f& uv : square.attributes.uv) uv += Vec2f(-7, 4);
  expect_near(square.at(0.4, 0.7), here, 1);
}

TEST(SurfaceColour, FineTexturesAreAveraged) {
  Square square;
  square.put_texture(checkers(64));
  const double texel = 1.0 / 64;
  EXPECT_EQ(square.at(0.5 * texel, 1 - 0.5 * texel), Rgba8{});
  EXPECT_EQ(square.at(1.5 * texel, 1 - 0.5 * texel), (Rgba8{0, 0, 0, 255}));
  for (const double area : {4 * texel * texel, 0.01, 1.0, 1e6}) {
    for (const double x : {0.1, 0.37, 0.92}) expect_near(square.at(x, 0.45, area), {180, 180, 180, 255}, 2);
  }
  // A level is chosen by the texels under the area, whatever the size of the face.
  square.put_texture(checkers(2), 32);
  expect_near(square.at(0.37, 0.45, 1), {180, 180, 180, 255}, 2);
}

TEST(SurfaceColour, AveragesKeepEvenColours) {
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 1}, {5, 3}, {1, 100}, {33, 64}}) {
    Square square;
    square.put_texture(image_of(width, height, std::vector<Rgba8>(width * height, {10, 200, 77, 128})));
    for (const double area : {0.0, 0.001, 0.1, 1.0}) EXPECT_EQ(square.at(0.3, 0.2, area), (Rgba8{10, 200, 77, 128})) << width;
  }
}

TEST(SurfaceColour, VertexColoursAreInterpolated) {
  Square square;
  square.attributes.colours = {kRed, kGreen, kBlue, kGrey};
  EXPECT_EQ(square.at(0, 0), kRed);
  EXPECT_EQ(square.at(1, 0), kGreen);
  EXPECT_EQ(square.at(1, 1), kBlue);
  expect_near(square.at(0.5, 0), {180, 180, 0, 255}, 1);
  expect_near(square.at(0.5, 0.5), {180, 0, 180, 255}, 1);
}

TEST(SurfaceColour, TheMostPreciseColourWins) {
  Square square;
  square.attributes.face_colours = {kRed, kGreen};
  EXPECT_EQ(square.at(0.6, 0.2), kRed);
  EXPECT_EQ(square.at(0.2, 0.6), kGreen);
  square.attributes.colours.assign(4, kGrey);
  EXPECT_EQ(square.at(0.6, 0.2), kGrey);
  square.put_texture(image_of(1, 1, {kBlue}));
  EXPECT_EQ(square.at(0.6, 0.2), kBlue);
  square.attributes.material_of_face[1] = MeshAttributes::kNoMaterial;
  EXPECT_EQ(square.at(0.2, 0.6), kGrey);
}

TEST(SurfaceColour, TheMaterialMultiplies) {
  Square square;
  square.put_texture(image_of(1, 1, {{200, 100, 50, 255}}), 1, {51, 255, 0, 255});
  expect_near(square.at(0.6, 0.2), {40, 100, 0, 255}, 1);
  square.put_texture(nullptr, 1, {51, 255, 0, 255});
  EXPECT_EQ(square.at(0.6, 0.2), (Rgba8{51, 255, 0, 255}));
}

TEST(SurfaceColour, PlacesThatAreNowhereDoNoHarm) {
  Square square;
  square.put_texture(image_of(1, 1, {kBlue}));
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 3e38F, -3e38F}) {
    for (Vec2f& uv : square.attributes.uv) uv.x() = bad;
    EXPECT_EQ(square.at(0.6, 0.2, 0.1), kBlue);
  }
}

TEST(SurfaceColour, KnowsWhetherThereIsAny) {
  Square square;
  EXPECT_FALSE(has_colour(square.attributes));
  square.put_texture(nullptr);
  EXPECT_FALSE(has_colour(square.attributes)) << "white is none";
  square.put_texture(nullptr, 1, kGrey);
  EXPECT_TRUE(has_colour(square.attributes));
  square.put_texture(checkers(2));
  EXPECT_TRUE(has_colour(square.attributes));
  square.attributes.uv.clear();
  EXPECT_FALSE(has_colour(square.attributes)) << "a texture without coordinates";
  square.attributes.face_colours.assign(2, kRed);
  EXPECT_TRUE(has_colour(square.attributes));
  square.attributes.face_colours.clear();
  square.attributes.colours.assign(4, kRed);
  EXPECT_TRUE(has_colour(square.attributes));
}

}  // namespace
}  // namespace curvecast
