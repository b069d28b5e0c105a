#include "core/render/mesh_renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <vector>

namespace curvecast {
namespace {

using ::testing::HasSubstr;

constexpr Rgb8 kBlue = {0, 0, 255};

/// Triangles whose vertices have normals.
struct Mesh {
  std::vector<Vec3d> positions;
  std::vector<Vec3f> normals;
  std::vector<Triangle> triangles;

  Vec3d at(std::uint32_t face, const Vec3f& w) const {
    const Triangle& t = triangles[face];
    return w[0] * positions[t[0]] + w[1] * positions[t[1]] + w[2] * positions[t[2]];
  }
  Vec3f normal_at(std::uint32_t face, const Vec3f& w) const {
    const Triangle& t = triangles[face];
    return w[0] * normals[t[0]] + w[1] * normals[t[1]] + w[2] * normals[t[2]];
  }
  MeshSurface surface() const {
    return {positions, triangles, [this](std::uint32_t face, const Vec3f& w, double) {
              return SurfaceLook{normal_at(face, w), {}};
            }};
  }
};

/// A sphere around the origin, of 2 n x n squares of two triangles each.
Mesh make_sphere(std::uint32_t n, double radius = 1) {
  Mesh mesh;
  for (std::uint32_t row = 0; row <= n; ++row) {
    for (std::uint32_t column = 0; column <= 2 * n; ++column) {
      const double up = std::numbers::pi * row / n, around = std::numbers::pi * column / n;
      const Vec3d p(std::sin(up) * std::cos(around), std::cos(up), -std::sin(up) * std::sin(around));
      mesh.positions.push_back(radius * p);
      mesh.normals.push_back(p.cast<float>());
    }
  }
  for (std::uint32_t row = 0; row < n; ++row) {
    for (std::uint32_t column = 0; column < 2 * n; ++column) {
      const std::uint32_t a = row * (2 * n + 1) + column, b = a + 2 * n + 1;
      mesh.triangles.push_back({a, b, a + 1});
      mesh.triangles.push_back({a + 1, b, b + 1});
    }
  }
  return mesh;
}

/// Adds a square of side 2 around (0, 0, z) that looks along +z or -z, as do its normals.
void add_square(double z, bool is_front, Mesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const auto& [x, y] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
    mesh.positions.emplace_back(x, y, z);
    mesh.normals.emplace_back(0, 0, is_front ? 1 : -1);
  }
  for (const std::uint32_t i : {1U, 2U}) {
    const std::uint32_t second = is_front ? i : i + 1, third = is_front ? i + 1 : i;
    mesh.triangles.push_back({first, first + second, first + third});
  }
}

RenderCamera camera_at(const Vec3d& eye) { return {eye, Vec3d::Zero(), Vec3d(0, 1, 0), 40}; }

RenderOptions small_options() {
  RenderOptions options;
  options.width = 200;
  options.height = 150;
  options.supersample = 1;
  options.background_top = options.background_bottom = kBlue;
  return options;
}

Rgb8 pixel(const Image& image, int x, int y) {
  const std::size_t i = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  return {image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]};
}

/// Tells whether there is background, or surface, within so many pixels.
bool is_near(bool background, const Image& image, int x, int y, int pixels) {
  for (int v = std::max(y - pixels, 0); v <= std::min(y + pixels, image.height - 1); ++v) {
    for (int u = std::max(x - pixels, 0); u <= std::min(x + pixels, image.width - 1); ++u) {
      if ((pixel(image, u, v) == kBlue) == background) return true;
    }
  }
  return false;
}

/// Of what lies more than so many pixels from the background of `a`, decibels.
double psnr(const Image& a, const Image& b, int pixels) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      if (is_near(true, a, x, y, pixels)) continue;
      const Rgb8 p = pixel(a, x, y), q = pixel(b, x, y);
      for (std::size_t c = 0; c < 3; ++c) sum += std::pow(int{p[c]} - int{q[c]}, 2);
      count += 3;
    }
  }
  EXPECT_GT(count, 1'000);
  return 10 * std::log10(255.0 * 255.0 * count / std::max(sum, 1.0));
}

/// From the middles of pixels into the scene.
struct Rays {
  Vec3d right, up, back;
  double scale;  // of a pixel, at distance 1
  RenderOptions options;

  Rays(const RenderCamera& camera, const RenderOptions& of_options) : options(of_options) {
    back = (camera.eye - camera.target).normalized();
    right = camera.up.cross(back).normalized();
    up = back.cross(right);
    scale = 2 * std::tan(camera.vertical_fov_degrees * std::numbers::pi / 360) / options.height;
  }
  /// In eye coordinates.
  Vec3d through(int x, int y) const {
    return {scale * (x + 0.5 - 0.5 * options.width), scale * (0.5 * options.height - y - 0.5), -1};
  }
  Vec3d to_eye(const Vec3d& v) const { return {right.dot(v), up.dot(v), back.dot(v)}; }
  Vec3d to_world(const Vec3d& v) const { return v.x() * right + v.y() * up + v.z() * back; }
};

TEST(MeshRendererTest, TheSilhouetteIsTheMeshs) {
  const Mesh sphere = make_sphere(200);
  const RenderOptions options = small_options();
  for (const Vec3d& eye : {Vec3d(0, 0, 4), Vec3d(1, 2, 3.5), Vec3d(0.3, -1.4, -0.2)}) {
    const RenderCamera camera = camera_at(eye);
    const Rays rays(camera, options);
    const absl::StatusOr<Image> image = render_mesh(sphere.surface(), camera, options);
    ASSERT_TRUE(image.ok()) << image.status();
    for (int y = 0; y < image->height; ++y) {
      for (int x = 0; x < image->width; ++x) {
        const double miss = eye.norm() * std::sin(std::acos(-rays.through(x, y).normalized().z()));  // of the ray's the origin
        if (std::abs(miss - 1) < 1e-3) continue;
        ASSERT_EQ(pixel(*image, x, y) == kBlue, miss > 1) << x << ", " << y;
      }
    }
  }
}

/// What the README's light makes of a place, without occlusion: written down a second time.
Vec3d shaded(const Vec3d& albedo, const Vec3d& n, const Vec3d& view) {
  const Vec3d key = Vec3d(-0.55, 0.75, 0.70).normalized(), fill = Vec3d(0.85, 0.10, 0.55).normalized();
  const auto wrapped = [&](const Vec3d& light, double wrap) {
    const double d = std::max((n.dot(light) + wrap) / (1 + wrap), 0.0);
    return d * d * (1 - 0.5 * wrap) + d * 0.5 * wrap;
  };
  const double up = 0.5 + 0.5 * n.y(), grazing = 1 - std::max(n.dot(view), 0.0);
  const Vec3d ambient = (1 - up) * Vec3d(0.13, 0.10, 0.085) + up * Vec3d(0.27, 0.29, 0.33);
  const Vec3d light = Vec3d(1.18, 1.12, 1.03) * wrapped(key, 0.15) + Vec3d(0.14, 0.17, 0.22) * wrapped(fill, 0.3) + ambient;
  const double sheen = std::pow(std::max(n.dot((key + view).normalized()), 0.0), 36);
  const double rim = grazing * grazing * grazing * (0.35 + 0.65 * up);
  return albedo.cwiseProduct(light) + Vec3d(0.09, 0.088, 0.085) * sheen + Vec3d(0.15, 0.16, 0.18) * rim;
}

double to_linear(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }
double to_srgb(double c) { return c < 0.0031308 ? 12.92 * c : 1.055 * std::pow(std::min(c, 1.0), 1 / 2.4) - 0.055; }

TEST(MeshRendererTest, ASphereIsShadedAsTheLightSays) {
  const Mesh sphere = make_sphere(200);
  RenderOptions options = small_options();
  options.ambient_occlusion = false;
  options.surface_color = Rgb8{180, 120, 90};
  const Vec3d albedo(to_linear(180 / 255.0), to_linear(120 / 255.0), to_linear(90 / 255.0));
  const RenderCamera camera = camera_at(Vec3d(1, 2, 3.5));
  const Rays rays(camera, options);
  const absl::StatusOr<Image> image = render_mesh(sphere.surface(), camera, options);
  ASSERT_TRUE(image.ok()) << image.status();
  int compared = 0;
  for (int y = 0; y < image->height; ++y) {
    for (int x = 0; x < image->width; ++x) {
      const Vec3d ray = rays.to_world(rays.through(x, y).normalized());
      const double along = -ray.dot(camera.eye), miss = std::sqrt(camera.eye.squaredNorm() - along * along);
      if (miss > 0.98) continue;
      ++compared;
      const Vec3d place = camera.eye + (along - std::sqrt(1 - miss * miss)) * ray;
      const Vec3d light = shaded(albedo, rays.to_eye(place), rays.to_eye(-ray));
      const Rgb8 seen = pixel(*image, x, y);
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(seen[c], 255 * to_srgb(light[c]), 1.6) << x << ", " << y;
    }
  }
  EXPECT_GT(compared, 5'000);
}

/// A bumpy thing that hides a part of itself, with stripes.
struct Bumps {
  Mesh mesh = make_sphere(120);

  Bumps() {
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      Vec3d normal;
      mesh.positions[i] = moved(mesh.positions[i], normal);
      mesh.normals[i] = normal.cast<float>();
    }
  }
  /// A place on the unit sphere on the bumps, and the normal there.
  static Vec3d moved(const Vec3d& p, Vec3d& normal) {
    const auto height = [](const Vec3d& q) { return 1 + 0.15 * std::sin(5 * q.x()) * std::sin(5 * q.y()) * std::sin(5 * q.z()); };
    constexpr double kStep = 1e-5;
    Vec3d slope;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3d step = kStep * Vec3d::Unit(axis);
      slope[axis] = (height(p + step) - height(p - step)) / (2 * kStep);
    }
    normal = (height(p) * p - (slope - slope.dot(p) * p)).normalized();
    return height(p) * p;
  }
  static Rgb8 color_of(const Vec3d& place) {
    const auto of = [](double x) { return static_cast<std::uint8_t>(std::lround(140 + 100 * std::sin(4 * x))); };
    return {of(place.x()), of(place.y()), of(place.z())};
  }
  MeshSurface surface() const {
    return {mesh.positions, mesh.triangles,
            [this](std::uint32_t face, const Vec3f& w, double) {
              return SurfaceLook{mesh.normal_at(face, w), color_of(mesh.at(face, w))};
            },
            true};
  }
  Image splats(int n, const RenderCamera& camera, const RenderOptions& options) const {
    std::vector<Vec3f> positions, normals;
    std::vector<Rgb8> colors;
    for (int i = 0; i < n; ++i) {
      const double z = 1 - (2 * i + 1.0) / n, angle = i * std::numbers::pi * (3 - std::sqrt(5.0)), r = std::sqrt(1 - z * z);
      Vec3d normal;
      positions.push_back(moved({r * std::cos(angle), r * std::sin(angle), z}, normal).cast<float>());
      normals.push_back(normal.cast<float>());
      colors.push_back(color_of(positions.back().cast<double>()));
    }
    const std::vector<float> radii(positions.size(), static_cast<float>(1.6 * std::sqrt(4.0 / n)));
    const absl::StatusOr<Image> image = render_splats({positions, normals, radii, colors}, camera, options);
    EXPECT_TRUE(image.ok()) << image.status();
    return image.value_or(Image());
  }
};

// But for the last pixel at the outline, where splats are as large as a sample, and end before it.
TEST(MeshRendererTest, PicturesOfManySplatsBecomeIt) {
  const Bumps bumps;
  RenderOptions options = small_options();
  options.width = 400;
  options.height = 300;
  options.supersample = 2;
  const RenderCamera camera = camera_at(Vec3d(1, 2, 3.5));
  const absl::StatusOr<Image> image = render_mesh(bumps.surface(), camera, options);
  ASSERT_TRUE(image.ok()) << image.status();
  double before = 0;
  for (const int n : {500, 5'000, 20'000, 50'000}) {
    const double now = psnr(*image, bumps.splats(n, camera, options), 3);
    EXPECT_GT(now, before + 1) << n;
    before = now;
  }
  EXPECT_GT(before, 48);
  const Image dense = bumps.splats(200'000, camera, options);
  EXPECT_GT(psnr(*image, dense, 3), 48);
  for (int y = 0; y < image->height; ++y) {
    for (int x = 0; x < image->width; ++x) {
      const bool is_covered = pixel(dense, x, y) != kBlue;
      ASSERT_TRUE(is_covered || is_near(true, *image, x, y, 1)) << x << ", " << y;
      ASSERT_TRUE(!is_covered || is_near(false, *image, x, y, 2)) << x << ", " << y;
    }
  }
}

TEST(MeshRendererTest, TheNearerTriangleIsSeenWhateverTheOrder) {
  const auto picture = [](const std::vector<double>& depths) {
    Mesh mesh;
    for (const double z : depths) add_square(z, true, mesh);
    const MeshSurface surface{mesh.positions, mesh.triangles,
                              [&](std::uint32_t face, const Vec3f& w, double) {
                                const bool is_near = mesh.at(face, w).z() > 0;
                                return SurfaceLook{mesh.normal_at(face, w), is_near ? Rgb8{200, 0, 0} : Rgb8{0, 200, 0}};
                              },
                              true};
    absl::StatusOr<Image> image = render_mesh(surface, camera_at(Vec3d(0, 0, 4)), small_options());
    EXPECT_TRUE(image.ok()) << image.status();
    return image.value_or(Image());
  };
  const Image image = picture({0.3, -0.3});
  EXPECT_EQ(picture({-0.3, 0.3}).rgba, image.rgba);
  const Rgb8 middle = pixel(image, 100, 75);
  EXPECT_GT(middle[0], 2 * middle[1]);
}

TEST(MeshRendererTest, BacksAreTurnedRound) {
  Mesh front, back;
  add_square(0, true, front);
  add_square(0, false, back);
  RenderCamera camera = camera_at(Vec3d(0, 0, 8));
  camera.vertical_fov_degrees = 10;
  const absl::StatusOr<Image> image = render_mesh(front.surface(), camera, small_options());
  ASSERT_TRUE(image.ok()) << image.status();
  EXPECT_NE(pixel(*image, 100, 75), kBlue);
  EXPECT_EQ(render_mesh(back.surface(), camera, small_options())->rgba, image->rgba);
}

TEST(MeshRendererTest, FromInsideEverythingIsSurface) {
  const Mesh sphere = make_sphere(40);
  const absl::StatusOr<Image> image = render_mesh(sphere.surface(), camera_at(Vec3d(0.1, 0.2, 0.3)), small_options());
  ASSERT_TRUE(image.ok()) << image.status();
  for (int y = 0; y < image->height; ++y) {
    for (int x = 0; x < image->width; ++x) ASSERT_NE(pixel(*image, x, y), kBlue) << x << ", " << y;
  }
}

/// Each sample asks for the place that it sees, and for its share of the surface.
TEST(MeshRendererTest, SamplesShareTheSurface) {
  Mesh mesh;
  add_square(0, true, mesh);
  for (const int supersample : {1, 3}) {
    RenderOptions options = small_options();
    options.supersample = supersample;
    for (const Vec3d& eye : {Vec3d(0, 0, 4), Vec3d(3, 1, 2.5)}) {
      std::mutex mutex;
      double sum = 0;
      Vec3d middle = Vec3d::Zero();
      const MeshSurface surface{mesh.positions, mesh.triangles, [&](std::uint32_t face, const Vec3f& w, double area) {
                                  const std::lock_guard lock(mutex);
                                  EXPECT_NEAR(w.sum(), 1, 1e-6);
                                  EXPECT_GE(w.minCoeff(), 0);
                                  sum += area;
                                  middle += area * mesh.at(face, w);
                                  return SurfaceLook{mesh.normal_at(face, w), {}};
                                }};
      ASSERT_TRUE(render_mesh(surface, camera_at(eye), options).ok());
      EXPECT_NEAR(sum, 4, 0.1);
      EXPECT_LT((middle / sum).norm(), 0.02);
    }
  }
}

TEST(MeshRendererTest, SizeAndPlaceMakeNoDifference) {
  const Image expected = *render_mesh(make_sphere(60).surface(), camera_at(Vec3d(0, 0, 4)), small_options());
  for (const double size : {1e-12, 1e-3, 1e12}) {
    Mesh sphere = make_sphere(60, size);
    const Vec3d center = Vec3d(16, -8, 4) * size;
    for (Vec3d& p : sphere.positions) p += center;
    RenderCamera camera = camera_at(Vec3d(0, 0, 4) * size + center);
    camera.target = center;
    const absl::StatusOr<Image> image = render_mesh(sphere.surface(), camera, small_options());
    ASSERT_TRUE(image.ok()) << image.status();
    EXPECT_GT(psnr(expected, *image, 0), 50) << size;
  }
}

TEST(MeshRendererTest, RefusesWhatIsNoPicture) {
  const Mesh sphere = make_sphere(4);
  const auto refusal = [&](const MeshSurface& surface, const RenderCamera& camera, const RenderOptions& options) {
    const absl::Status status = render_mesh(surface, camera, options).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    return std::string(status.message());
  };
  const RenderCamera camera = camera_at(Vec3d(0, 0, 4));
  EXPECT_THAT(refusal({}, camera, small_options()), HasSubstr("without triangles"));
  EXPECT_THAT(refusal(sphere.surface(), camera_at(Vec3d::Zero()), small_options()), HasSubstr("no direction"));
  RenderOptions options = small_options();
  options.supersample = 5;
  EXPECT_THAT(refusal(sphere.surface(), camera, options), HasSubstr("supersample is 5"));
}

TEST(MeshRendererTest, StopsWhenItIsCancelled) {
  const Mesh sphere = make_sphere(40);
  std::atomic<bool> cancel = true;
  const ExecutionContext context{.cancel = &cancel};
  const RenderCamera camera = camera_at(Vec3d(0, 0, 4));
  EXPECT_TRUE(absl::IsCancelled(render_mesh(sphere.surface(), camera, small_options(), context).status()));
  // While it is under way, too.
  cancel = false;
  MeshSurface surface = sphere.surface();
  surface.look = [&](std::uint32_t, const Vec3f&, double) {
    cancel = true;
    return SurfaceLook{};
  };
  EXPECT_TRUE(absl::IsCancelled(render_mesh(surface, camera, small_options(), context).status()));
}

}  // namespace
}  // namespace curvecast
