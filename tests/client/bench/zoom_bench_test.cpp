// The way down to the surface, on small meshes.
#include "client/bench/zoom_bench.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <numeric>
#include <string>

#include "client/bench/scene/mesh_picture.h"
#include "client/bench/scene/stop_picture.h"
#include "client/bench/scene/zoom_path.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::cli::bench {
namespace {

namespace shapes = curvecast::testing;

double covered_pixels(const MeshPicture& picture) { return std::accumulate(picture.covered.begin(), picture.covered.end(), 0.0); }

TEST(MeshPicture, CoversTheOutline) {
  const TriangleMesh ball = shapes::make_mesh(shapes::icosphere(5));
  const RenderCamera camera{.eye = Vec3d(0, 0, 3), .vertical_fov_degrees = 60};
  const MeshPicture picture = draw_mesh(ball, camera, 300, 200);
  // A ball of radius 1 from a distance of 3 is a disc of tangent 1 / sqrt(8).
  const double radius = 100 / std::tan(std::numbers::pi / 6) / std::sqrt(8.0);
  EXPECT_NEAR(covered_pixels(picture) / (std::numbers::pi * radius * radius), 1, 0.02);
  EXPECT_EQ(picture.covered[100 * 300 + 150], 1);
  EXPECT_EQ(picture.covered[0], 0);
  // It is lit where it faces the eye.
  const auto red = [&](std::size_t pixel) { return picture.image.rgba[4 * pixel]; };
  EXPECT_GT(red(100 * 300 + 150), 1.5 * red(100 * 300 + 150 + static_cast<std::size_t>(0.97 * radius)));
}

TEST(MeshPicture, DrawsFacesThatReachBehindTheEye) {
  // A floor from far behind the eye to far before it: the lower half of the picture.
  const TriangleMesh floor = shapes::make_mesh(shapes::translated(shapes::scaled(shapes::square(1), 1e6), Vec3d(-5e5, -5e5, 0)));
  const RenderCamera camera{.eye = Vec3d(0, 0, 1), .target = Vec3d(0, 1, 1), .up = Vec3d(0, 0, 1)};
  const MeshPicture picture = draw_mesh(floor, camera, 40, 40);
  EXPECT_EQ(covered_pixels(picture), 40 * 20);
  EXPECT_EQ(picture.covered[19 * 40], 0);
  EXPECT_EQ(picture.covered[20 * 40], 1);
}

TEST(Wireframe, ShowsTheSidesOfTrianglesThatCanBeSeen) {
  const RenderCamera camera{.eye = Vec3d(0.5, 0.5, 3), .target = Vec3d(0.5, 0.5, 0), .vertical_fov_degrees = 25};
  const PolygonSoup square = shapes::square(1);
  const Image image = draw_wireframe(shapes::make_mesh(square), camera, 120, 120);
  const auto red = [&](int x, int y) { return int{image.rgba[static_cast<std::size_t>(4 * (120 * y + x))]}; };
  const int face = red(60, 45);
  EXPECT_LT(std::min(red(60, 60), red(59, 60)), 0.9 * face);  // the diagonal, whichever it is
  EXPECT_EQ(red(75, 60), face);
  EXPECT_GT(red(2, 2), face);  // the background
  // Finer triangles behind it are hidden; before it they are not.
  const PolygonSoup fine = shapes::translated(shapes::scaled(shapes::square(9), 0.5), Vec3d(0.25, 0.25, -1));
  EXPECT_EQ(draw_wireframe(shapes::make_mesh(shapes::merged(square, fine)), camera, 120, 120).rgba, image.rgba);
  const PolygonSoup nearer = shapes::translated(fine, Vec3d(0, 0, 2));
  EXPECT_NE(draw_wireframe(shapes::make_mesh(shapes::merged(square, nearer)), camera, 120, 120).rgba, image.rgba);
}

/// Points of a ball about (0, 0, 0) at all latitudes, with discs that overlap, where z > least.
client::Points ball_points(float least) {
  client::Points points;
  for (std::size_t i = 0; i < 5000; ++i) {
    const double z = 1 - 2 * (static_cast<double>(i) + 0.5) / 5000, angle = 2.4 * static_cast<double>(i);
    const double ring = std::sqrt(1 - z * z);
    const std::array<float, 3> p = {static_cast<float>(ring * std::cos(angle)), static_cast<float>(ring * std::sin(angle)),
                                    static_cast<float>(z)};
    if (p[2] < least) continue;
    points.positions.push_back(p);
    points.normals.push_back(p);
    points.radii.push_back(0.06F);
  }
  return points;
}

TEST(StopPicture, TellsHowMuchOfTheMeshThePointsCover) {
  const shapes::TemporaryFolder folder;
  const std::string path = folder / "stop.png";
  const TriangleMesh ball = shapes::make_mesh(shapes::icosphere(4));
  v1::Camera camera;
  camera.mutable_eye()->set_z(50);
  camera.mutable_target();
  camera.mutable_up()->set_y(1);
  camera.set_vertical_fov_degrees(2.5);
  v1::Viewport viewport;
  viewport.set_width(200);
  viewport.set_height(160);
  const auto coverage = [&](const client::Points& points) {
    const absl::StatusOr<double> drawn = draw_stop(points, ball, camera, viewport, path);
    EXPECT_TRUE(drawn.ok()) << drawn.status();
    return drawn.value_or(-1);
  };
  EXPECT_GT(coverage(ball_points(-1)), 0.99);
  EXPECT_EQ(coverage({}), 0);
  EXPECT_GT(std::filesystem::file_size(path), 1000u);
  // The cap where z > 0.8 has a share of 1 - 0.8^2 of the disc; its discs reach a little farther.
  const double cap = coverage(ball_points(0.8F));
  EXPECT_GT(cap, 0.34);
  EXPECT_LT(cap, 0.48);
}

TEST(ZoomPath, LooksAtPlacesOfTheSurface) {
  const TriangleMesh ball = shapes::make_mesh(shapes::icosphere(4));
  EXPECT_GT(front_of(ball).position.z(), 0.9);
  double least = 1, most = -1;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const SurfacePlace place = seed == 0 ? front_of(ball) : random_place(ball, seed);
    EXPECT_NEAR(place.position.norm(), 1, 0.01);
    EXPECT_GT(place.normal.dot(place.position), 0.98);
    least = std::min(least, place.position.x()), most = std::max(most, place.position.x());
    const v1::Camera camera = camera_above(place, 0.1, 7.0 * static_cast<double>(seed));
    const Vec3d eye(camera.eye().x(), camera.eye().y(), camera.eye().z());
    EXPECT_NEAR((eye - place.position).norm(), 0.1, 1e-12);
    EXPECT_GT((eye - place.position).dot(place.normal), 0.098);
    EXPECT_EQ(camera.target().x(), place.position.x());
  }
  EXPECT_LT(least, -0.8);
  EXPECT_GT(most, 0.8);
}

TEST(ZoomBench, TellsOfEachStopAndOfTheMotion) {
  const shapes::TemporaryFolder folder;
  const std::string off = shapes::to_off(shapes::icosphere(3));
  const ZoomBenchOptions options{.points = {400, 300},
                                 .frames = 12,
                                 .stops = 2,
                                 .rate = 500,
                                 .nearest = 0.1,
                                 .width = 160,
                                 .height = 120,
                                 .wander = 2,
                                 .pictures = folder / "pictures",
                                 .command = CURVECAST_COMMAND};
  const absl::StatusOr<BenchReport> report = bench_zoom({"ball.off", off}, options, {});
  ASSERT_TRUE(report.ok()) << report.status();
  const Json json = bench_json(*report);
  ASSERT_EQ(json["tables"].size(), 2u);
  for (std::size_t t = 0; t < 2; ++t) {
    const std::uint64_t wanted = options.points[t];
    const Json& rows = json["tables"][t]["rows"];
    ASSERT_EQ(rows.size(), 4u);
    for (const Json& row : rows) {
      EXPECT_EQ(row["points"], wanted) << row.dump();
      EXPECT_EQ(row["wanted"], wanted);
      EXPECT_EQ(row["limit"], "none");
      EXPECT_GT(row["frames"], 0);
      EXPECT_GT(row["coverage %"], 90);
    }
    EXPECT_EQ(rows[0]["way"], "down");
    EXPECT_NEAR(rows[1]["distance/size"].get<double>(), 0.1, 1e-9);
    EXPECT_EQ(rows[3]["way"], "up");
    EXPECT_NEAR(rows[3]["distance/size"].get<double>(), 1.25, 1e-9);
    EXPECT_GT(rows[0]["key KiB"].get<double>() + rows[0]["delta KiB"].get<double>(), 0);
  }
  std::size_t pictures = 0;
  for (const auto& file : std::filesystem::directory_iterator(options.pictures)) pictures += file.path().extension() == ".png";
  EXPECT_EQ(pictures, 8u);
  const auto value = [&](const std::string& name) {
    const auto found = std::ranges::find(report->results, name, &BenchResult::name);
    EXPECT_NE(found, report->results.end()) << name;
    return found != report->results.end() ? found->value : 0;
  };
  EXPECT_EQ(value("N = 300: views"), 13);
  EXPECT_GE(value("N = 300: memory of the server, at most"), value("N = 300: memory of the server, in the end"));
  EXPECT_GT(value("N = 400: memory of the server after 2 views of random places"), 0);
  EXPECT_NE(bench_text(*report).find("distance/size"), std::string::npos);
}

TEST(ZoomBench, RefusesWhatIsNoWay) {
  const std::string off = shapes::to_off(shapes::tetrahedron());
  const auto code = [&](const ZoomBenchOptions& options) {
    return bench_zoom({"tetrahedron.off", off}, options, {}).status().code();
  };
  EXPECT_EQ(code({.points = {}}), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code({.stops = 0}), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code({.nearest = 2}), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code({.pictures = "/dev/null/pictures"}), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(code({.command = "/bin/false"}), absl::StatusCode::kUnavailable);
  EXPECT_FALSE(bench_zoom({"bad.off", {}}, {.command = CURVECAST_COMMAND}, {}).ok());
}

}  // namespace
}  // namespace curvecast::cli::bench
