#include "core/render/splat_renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

namespace curvecast {
namespace {

using ::testing::HasSubstr;

constexpr Rgb8 kRed = {220, 20, 20}, kGreen = {20, 200, 20}, kBlue = {0, 0, 255};

struct Points {
  std::vector<Vec3f> positions, normals;
  std::vector<float> radii;
  std::vector<Rgb8> colors;

  void add(const Vec3f& position, const Vec3f& normal, float radius, const Rgb8& color = kRed) {
    positions.push_back(position);
    normals.push_back(normal);
    radii.push_back(radius);
    colors.push_back(color);
  }
  SplatCloud cloud() const { return {positions, normals, radii, {}}; }
  SplatCloud colored_cloud() const { return {positions, normals, radii, colors}; }
};

// An even distribution over the sphere; `overlap` 1 is the radius at which discs of area A / N would just fill it.
Points make_sphere(int n, double overlap, double radius = 1, const Vec3f& center = Vec3f::Zero()) {
  Points points;
  const double disc = overlap * radius * std::sqrt(4.0 / n);
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (2 * i + 1.0) / n;
    const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    const Vec3f normal = Vec3d(r * std::cos(angle), r * std::sin(angle), z).cast<float>();
    points.add(center + static_cast<float>(radius) * normal, normal, static_cast<float>(disc));
  }
  return points;
}

// A square of side 2 across the axis of view.
Points make_plane(float z, float nz, const Rgb8& color) {
  Points points;
  for (int i = -20; i <= 20; ++i) {
    for (int j = -20; j <= 20; ++j) points.add(Vec3f(0.05F * i, 0.05F * j, z), Vec3f(0, 0, nz), 0.06F, color);
  }
  return points;
}

RenderCamera camera_at(const Vec3d& eye) { return {eye, Vec3d::Zero(), Vec3d(0, 1, 0), 40}; }

RenderOptions small_options() {
  RenderOptions options;
  options.width = 200;
  options.height = 150;
  options.background_top = options.background_bottom = kBlue;
  return options;
}

Rgb8 pixel(const Image& image, int x, int y) {
  const std::size_t i = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  return {image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]};
}

bool is_reddish(const Rgb8& c) { return c[0] > 2 * c[1] && c[0] > 2 * c[2]; }
bool is_greenish(const Rgb8& c) { return c[1] > 2 * c[0] && c[1] > 2 * c[2]; }

// A disc of `radius` pixels in the middle of the picture and nothing else; up to `slack` pixels at its edge.
void expect_disc(const Image& image, double radius, double slack) {
  int covered = 0, holes = 0, strays = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const bool is_covered = pixel(image, x, y) != kBlue;
      const double distance = std::hypot(x + 0.5 - 0.5 * image.width, y + 0.5 - 0.5 * image.height);
      covered += is_covered;
      holes += !is_covered && distance < radius - slack;
      strays += is_covered && distance > radius + slack;
    }
  }
  const double area = std::numbers::pi * radius * radius;
  EXPECT_NEAR(covered, area, 2 * std::numbers::pi * radius * slack);
  EXPECT_EQ(holes, 0);
  EXPECT_EQ(strays, 0);
}

double sphere_pixels(double distance, const RenderOptions& options) {
  return std::tan(std::asin(1 / distance)) / std::tan(20 * std::numbers::pi / 180) * options.height / 2;
}

TEST(SplatRendererTest, SphereIsADiscWithoutHoles) {
  RenderOptions options = small_options();
  options.supersample = 1;
  const RenderCamera camera = camera_at(Vec3d(1, 2, 3.5));
  const double radius = sphere_pixels(camera.eye.norm(), options);
  for (const int n : {2'000, 20'000, 200'000}) {
    for (const double overlap : {1.35, 2.0}) {
      SCOPED_TRACE(std::to_string(n) + " splats, overlap " + std::to_string(overlap));
      const absl::StatusOr<Image> image = render_splats(make_sphere(n, overlap).cloud(), camera, options);
      ASSERT_TRUE(image.ok()) << image.status();
      expect_disc(*image, radius, 1.2);
    }
  }
}

TEST(SplatRendererTest, MissingRadiiAndNormalsAreReplaced) {
  RenderOptions options = small_options();
  options.supersample = 1;
  const RenderCamera camera = camera_at(Vec3d(0, 0, 4));
  const double radius = sphere_pixels(4, options);
  const Points sphere = make_sphere(20'000, 1.5);
  const std::vector<Vec3f> zeros(sphere.positions.size(), Vec3f::Zero());
  for (const SplatCloud& cloud :
       {SplatCloud{sphere.positions, sphere.normals, {}, {}}, SplatCloud{sphere.positions, {}, {}, {}},
        SplatCloud{sphere.positions, {}, sphere.radii, {}}, SplatCloud{sphere.positions, zeros, sphere.radii, {}}}) {
    const absl::StatusOr<Image> image = render_splats(cloud, camera, options);
    ASSERT_TRUE(image.ok()) << image.status();
    // Discs that face the camera stick out of the silhouette.
    expect_disc(*image, radius, 3);
  }
}

TEST(SplatRendererTest, SizeAndPlaceOfTheCloudMakeNoDifference) {
  const RenderOptions options = small_options();
  const Image expected = *render_splats(make_sphere(5'000, 1.5).cloud(), camera_at(Vec3d(0, 0, 4)), options);
  for (const double size : {1e-12, 1e-3, 1e12}) {
    RenderCamera camera = camera_at(Vec3d(0, 0, 4));
    const Vec3d center = Vec3d(16, -8, 4) * size;
    camera.eye = camera.eye * size + center;
    camera.target = center;
    const Points sphere = make_sphere(5'000, 1.5, size, center.cast<float>());
    const absl::StatusOr<Image> image = render_splats(sphere.cloud(), camera, options);
    ASSERT_TRUE(image.ok()) << image.status();
    int difference = 0;
    for (std::size_t i = 0; i < expected.rgba.size(); ++i) difference += std::abs(expected.rgba[i] - image->rgba[i]) > 16;
    EXPECT_LT(difference, 200) << size;
  }
}

TEST(SplatRendererTest, NearerSplatsHideFartherOnes) {
  Points both = make_plane(0.3F, 1, kRed);
  const Points back = make_plane(-0.3F, -1, kGreen);
  for (std::size_t i = 0; i < back.positions.size(); ++i) both.add(back.positions[i], back.normals[i], back.radii[i], kGreen);
  const Image front_view = *render_splats(both.colored_cloud(), camera_at(Vec3d(0, 0, 5)), small_options());
  const Image back_view = *render_splats(both.colored_cloud(), camera_at(Vec3d(0, 0, -5)), small_options());
  for (int y = 60; y < 90; ++y) {
    for (int x = 85; x < 115; ++x) {
      EXPECT_TRUE(is_reddish(pixel(front_view, x, y)));
      EXPECT_TRUE(is_greenish(pixel(back_view, x, y)));
    }
  }
}

// Each of the crossing discs is in front on one side: a depth per splat could not do that.
TEST(SplatRendererTest, DepthIsThatOfTheTiltedDisc) {
  Points cross;
  cross.add(Vec3f::Zero(), Vec3f(-1, 0, 1), 1, kRed);   // rises to the right
  cross.add(Vec3f::Zero(), Vec3f(1, 0, 1), 1, kGreen);  // rises to the left
  const Image image = *render_splats(cross.colored_cloud(), camera_at(Vec3d(0, 0, 5)), small_options());
  EXPECT_FALSE(is_greenish(pixel(image, 114, 75)));
  EXPECT_FALSE(is_reddish(pixel(image, 86, 75)));
  EXPECT_GT(pixel(image, 114, 75)[0], pixel(image, 86, 75)[0]);
  EXPECT_GT(pixel(image, 86, 75)[1], pixel(image, 114, 75)[1]);
}

TEST(SplatRendererTest, UpIsUpAndRightIsRight) {
  Points points;
  points.add(Vec3f(0.5F, 0.5F, 0), Vec3f(0, 0, 1), 0.2F, kRed);
  points.add(Vec3f(-0.5F, -0.5F, 0), Vec3f(0, 0, 1), 0.2F, kGreen);
  const Image image = *render_splats(points.colored_cloud(), camera_at(Vec3d(0, 0, 3)), small_options());
  EXPECT_TRUE(is_reddish(pixel(image, 134, 41)));
  EXPECT_TRUE(is_greenish(pixel(image, 66, 109)));
  EXPECT_EQ(pixel(image, 66, 41), kBlue);
}

TEST(SplatRendererTest, OpenSurfacesAreShadedFromBothSides) {
  const Image front = *render_splats(make_plane(0, 1, kRed).cloud(), camera_at(Vec3d(0, 0, 5)), small_options());
  const Image back = *render_splats(make_plane(0, -1, kRed).cloud(), camera_at(Vec3d(0, 0, 5)), small_options());
  EXPECT_EQ(front.rgba, back.rgba);
}

TEST(SplatRendererTest, DotsBehindTheSurfaceAreHidden) {
  RenderOptions options = small_options();
  options.mode = RenderMode::kDots;
  options.dot_diameter = 7;
  const Points sphere = make_sphere(5'000, 1.5);
  const RenderCamera camera = camera_at(Vec3d(0, 0, 4));
  const auto count_dark = [](const Image& image) {
    int dark = 0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) dark += image.rgba[i] < 110 && image.rgba[i + 2] < 110;
    return dark;
  };
  const std::vector<Vec3f> front = {Vec3f(0, 0, 1)}, back = {Vec3f(0, 0, -1)};
  const Image with_front = *render_splats(sphere.cloud(), camera, options, front);
  const Image with_back = *render_splats(sphere.cloud(), camera, options, back);
  EXPECT_NEAR(count_dark(with_front), std::numbers::pi * 3.5 * 3.5, 10);
  EXPECT_EQ(count_dark(with_back), 0);
  const Rgb8 center = pixel(with_front, 100, 75);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(center[i], options.dot_color[i], 1);

  // The cloud's own points: as many as face the camera.
  options.dot_diameter = 6;
  options.width = 800;
  options.height = 600;
  const Points few = make_sphere(500, 1.5);
  const Image own = *render_splats(few.cloud(), camera, options);
  int visible = 0;
  for (const Vec3f& p : few.positions) visible += p.z() > 0.25F;
  const double area = visible * std::numbers::pi * 3 * 3;
  EXPECT_NEAR(count_dark(own), area, 0.2 * area);
}

TEST(SplatRendererTest, DotsHaveTheirOwnColoursOnAShadedSurface) {
  RenderOptions options = small_options();
  options.mode = RenderMode::kDots;
  options.dot_diameter = 9;
  const Points sphere = make_sphere(5'000, 1.5);
  const RenderCamera camera = camera_at(Vec3d(0, 0, 4));
  const std::vector<Vec3f> dots = {Vec3f(-0.5F, 0, 0.866F), Vec3f(0.5F, 0, 0.866F)};
  const std::vector<Rgb8> colors = {Rgb8{200, 10, 10}, Rgb8{10, 200, 10}};
  for (const bool is_matte : {true, false}) {
    options.matte_under_dots = is_matte;
    const Image image = *render_splats(sphere.cloud(), camera, options, dots, colors);
    const auto count = [&](auto&& holds) {
      int n = 0;
      for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) n += holds(pixel(image, x, y));
      }
      return n;
    };
    EXPECT_NEAR(count(is_reddish), std::numbers::pi * 4.5 * 4.5, 15);
    EXPECT_NEAR(count(is_greenish), std::numbers::pi * 4.5 * 4.5, 15);
  }
  // In kSurface's shading the surface is darker at the edge than under dots.
  const auto rim = [&](bool is_matte) {
    options.matte_under_dots = is_matte;
    return pixel(*render_splats(sphere.cloud(), camera, options, dots, colors), 100, 30)[1];
  };
  EXPECT_LT(rim(false), rim(true));
  EXPECT_EQ(render_splats(sphere.cloud(), camera, options, dots, std::vector<Rgb8>(1)).status().code(),
            absl::StatusCode::kInvalidArgument);
}

TEST(SplatRendererTest, SamePictureEveryTimeAndFromEveryThread) {
  const Points sphere = make_sphere(3'000, 1.5);
  const RenderCamera camera = camera_at(Vec3d(1, 1, 3));
  for (const RenderMode mode : {RenderMode::kSurface, RenderMode::kDots}) {
    RenderOptions options = small_options();
    options.mode = mode;
    const Image expected = *render_splats(sphere.colored_cloud(), camera, options);
    std::vector<Image> images(4);
    std::vector<std::thread> threads;
    for (Image& image : images) {
      threads.emplace_back([&] {
        for (int i = 0; i < 3; ++i) image = *render_splats(sphere.colored_cloud(), camera, options);
      });
    }
    for (std::thread& thread : threads) thread.join();
    for (const Image& image : images) EXPECT_EQ(image.rgba, expected.rgba);
  }
}

TEST(SplatRendererTest, CamerasInsideOrTurnedAwayAreHarmless) {
  const Points sphere = make_sphere(5'000, 1.5);
  const Image inside = *render_splats(sphere.cloud(), {Vec3d::Zero(), Vec3d(0, 0, 1), Vec3d(0, 1, 0), 60}, small_options());
  for (std::size_t i = 0; i < inside.rgba.size(); i += 4) ASSERT_GT(inside.rgba[i], 0) << "background seen from inside";
  const Image away = *render_splats(sphere.cloud(), {Vec3d(0, 0, 4), Vec3d(0, 0, 5), Vec3d(0, 1, 0), 60}, small_options());
  for (std::size_t i = 0; i < away.rgba.size(); i += 4) ASSERT_EQ(away.rgba[i], 0);
  const Vec3d on_it = sphere.positions[0].cast<double>();
  EXPECT_TRUE(render_splats(sphere.cloud(), {on_it, Vec3d::Zero(), Vec3d(1, 0, 0), 179}, small_options()).ok());
}

TEST(SplatRendererTest, ExtremeRadiiAreHarmless) {
  Points points = make_sphere(100, 1);
  for (const float radius : {0.0F, 1e-38F, 1e10F, std::numeric_limits<float>::max()}) {
    std::fill(points.radii.begin(), points.radii.end(), radius);
    EXPECT_TRUE(render_splats(points.cloud(), camera_at(Vec3d(0, 0, 4)), small_options()).ok()) << radius;
  }
}

TEST(SplatRendererTest, SinglePointsAreDrawn) {
  const std::vector<Vec3f> one = {Vec3f(3, 4, 5)};
  const RenderCamera camera = {Vec3d(3, 4, 9), Vec3d(3, 4, 5), Vec3d(0, 1, 0), 40};
  const Image image = *render_splats({one, {}, {}, {}}, camera, small_options());
  EXPECT_NE(pixel(image, 100, 75), kBlue);
}

struct BadCase {
  std::string message;
  std::function<void(Points&, RenderCamera&, RenderOptions&)> spoil;
};

TEST(SplatRendererTest, RefusesBadInput) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::vector<BadCase> cases = {
      {"empty", [](auto& p, auto&, auto&) { p = Points(); }},
      {"normals", [](auto& p, auto&, auto&) { p.normals.pop_back(); }},
      {"radii", [](auto& p, auto&, auto&) { p.radii.push_back(1); }},
      {"colours", [](auto& p, auto&, auto&) { p.colors.pop_back(); }},
      {"position of splat 7", [](auto& p, auto&, auto&) { p.positions[7].y() = static_cast<float>(kNan); }},
      {"normal of splat 8", [](auto& p, auto&, auto&) { p.normals[8].x() = static_cast<float>(kInfinity); }},
      {"radius of splat 9", [](auto& p, auto&, auto&) { p.radii[9] = -1; }},
      {"radius of splat 9", [](auto& p, auto&, auto&) { p.radii[9] = static_cast<float>(kNan); }},
      {"not finite", [](auto&, auto& c, auto&) { c.eye.x() = kNan; }},
      {"not finite", [](auto&, auto& c, auto&) { c.up.x() = kInfinity; }},
      {"not finite", [](auto&, auto& c, auto&) { c.vertical_fov_degrees = kNan; }},
      {"angle of view", [](auto&, auto& c, auto&) { c.vertical_fov_degrees = 180; }},
      {"angle of view", [](auto&, auto& c, auto&) { c.vertical_fov_degrees = 0; }},
      {"direction", [](auto&, auto& c, auto&) { c.eye = c.target; }},
      {"up", [](auto&, auto& c, auto&) { c.up = Vec3d::Zero(); }},
      {"up", [](auto&, auto& c, auto&) { c.up = c.eye - c.target; }},
      {"too far", [](auto&, auto& c, auto&) { c.eye *= 1e100; }},
      {"pixels", [](auto&, auto&, auto& o) { o.width = 0; }},
      {"pixels", [](auto&, auto&, auto& o) { o.height = -5; }},
      {"pixels", [](auto&, auto&, auto& o) { o.width = 8193; }},
      {"pixels", [](auto&, auto&, auto& o) { o.width = 16385, o.supersample = 1; }},
      {"samples", [](auto&, auto&, auto& o) { o.width = o.height = 8192; }},
      {"supersample", [](auto&, auto&, auto& o) { o.supersample = 0; }},
      {"supersample", [](auto&, auto&, auto& o) { o.supersample = 5; }},
      {"radius_scale", [](auto&, auto&, auto& o) { o.radius_scale = 0; }},
      {"radius_scale", [](auto&, auto&, auto& o) { o.radius_scale = kNan; }},
      {"dot_diameter", [](auto&, auto&, auto& o) { o.dot_diameter = 65; }},
  };
  for (const BadCase& bad : cases) {
    Points points = make_sphere(10, 1);
    RenderCamera camera = camera_at(Vec3d(0, 0, 4));
    RenderOptions options = small_options();
    bad.spoil(points, camera, options);
    const absl::Status status = render_splats(points.colored_cloud(), camera, options).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << bad.message;
    EXPECT_THAT(std::string(status.message()), HasSubstr(bad.message));
  }
}

TEST(SplatRendererTest, DotsHaveColoursOfTheirOwn) {
  const Points plane = make_plane(0, 1, kGreen);
  const std::vector<Vec3f> dots = {Vec3f(0, 0, 0.01F)};
  const std::vector<Rgb8> blue = {kBlue};
  RenderOptions options;
  options.width = options.height = 33;
  options.mode = RenderMode::kDots;
  options.dot_diameter = 9;
  const auto centre = [&](std::span<const Rgb8> colors) {
    const absl::StatusOr<Image> image = render_splats(plane.colored_cloud(), camera_at({0, 0, 4}), options, dots, colors);
    EXPECT_TRUE(image.ok()) << image.status();
    const std::uint8_t* pixel = &image->rgba[4 * (16 * 33 + 16)];
    return Rgb8{pixel[0], pixel[1], pixel[2]};
  };
  EXPECT_GT(centre(blue)[2], 240);
  EXPECT_LT(centre(blue)[0], 15);
  EXPECT_LT(centre({})[2], 60) << "dark, whatever the colours of the cloud that makes the surface";
  EXPECT_FALSE(render_splats(plane.cloud(), camera_at({0, 0, 4}), options, dots, std::vector<Rgb8>(2, kRed)).ok());
}

}  // namespace
}  // namespace curvecast
