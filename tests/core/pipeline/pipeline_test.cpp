#include "core/pipeline/pipeline.h"

#include <absl/strings/str_format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "core/mesh_io/mesh_io.h"
#include "core/sample/resample.h"
#include "tests/support/real_mesh.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using ::testing::HasSubstr;

absl::StatusOr<Preprocessed> run(const std::string& off, const PreprocessOptions& options = {.points = 2000}, int threads = 0) {
  return preprocess({"shape.off", off}, options, {.threads = threads});
}

TEST(Pipeline, TakesEveryShapeToACurve) {
  using namespace curvecast::testing;
  const std::vector<PolygonSoup> shapes = {disc(6, 20),
                                           sphere(16, 24),
                                           torus(24, 12),
                                           perforated_slab(5, 3),
                                           open_cylinder(10, 16),
                                           mobius_strip(30),
                                           single_triangle(),
                                           tetrahedron(),
                                           cube(),
                                           merged(sphere(8, 12), translated(torus(12, 8), {4, 0, 0}))};
  for (const PolygonSoup& soup : shapes) {
    const absl::StatusOr<Preprocessed> result = run(to_off(soup));
    ASSERT_TRUE(result.ok()) << result.status().message();
    const PreprocessReport& report = result->report;
    EXPECT_EQ(report.flipped_triangles, 0u);
    EXPECT_LT(report.area_error, 1e-6);
    EXPECT_GE(report.curve_vertices, 20'000u);
    EXPECT_EQ(report.curve_vertices, result->curve->size());
    EXPECT_GE(report.distortion.p50, 1);
    EXPECT_LE(report.distortion.p50, report.distortion.p99);
    EXPECT_LE(report.distortion.p99, report.distortion.p999);
    EXPECT_LE(report.distortion.p999, report.distortion.max);
    EXPECT_NEAR(report.mesh.area, surface_area(make_mesh(soup)), 1e-9);
  }
}

TEST(Pipeline, BakesColoursWhereThereAreAny) {
  const PolygonSoup soup = curvecast::testing::icosphere(2);
  std::string plain, coloured;
  for (const Vec3d& p : soup.positions) {
    const std::string place = "v " + std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z());
    plain += place + "\n";
    coloured += place + (p.z() > 0 ? " 1 0 0\n" : " 0 0 1\n");
  }
  std::string faces;
  for (std::size_t i = 0; i < soup.indices.size(); ++i) {
    faces += (i % 3 == 0 ? "\nf " : " ") + std::to_string(soup.indices[i] + 1);
  }
  plain += faces + "\n";
  coloured += faces + "\n";
  const PreprocessOptions options = {.points = 2000};
  const absl::StatusOr<Preprocessed> without = preprocess({"a.obj", plain}, options);
  const absl::StatusOr<Preprocessed> with = preprocess({"a.obj", coloured}, options, {.threads = 2});
  const absl::StatusOr<Preprocessed> again = preprocess({"a.obj", coloured}, options, {.threads = 1});
  ASSERT_TRUE(without.ok() && with.ok() && again.ok());
  EXPECT_TRUE(without->curve->colour.empty());
  ASSERT_EQ(with->curve->colour.size(), with->curve->size());
  EXPECT_EQ(with->curve->x, without->curve->x);
  EXPECT_EQ(with->curve->colour, again->curve->colour);
  for (std::size_t l = 0; l < with->curve->size(); ++l) {
    if (std::abs(with->curve->z[l]) < 0.4f) continue;  // faces of both colours
    EXPECT_EQ(with->curve->colour[l], with->curve->z[l] > 0 ? (Rgba8{255, 0, 0}) : (Rgba8{0, 0, 255}));
  }
}

TEST(Pipeline, TheNumberOfThreadsChangesNothing) {
  const std::string off = curvecast::testing::to_off(curvecast::testing::torus(60, 30));
  const absl::StatusOr<Preprocessed> one = run(off, {.points = 20'000}, 1);
  const absl::StatusOr<Preprocessed> two = run(off, {.points = 20'000}, 2);
  ASSERT_TRUE(one.ok() && two.ok());
  EXPECT_EQ(one->curve->x, two->curve->x);
  EXPECT_EQ(one->curve->nz, two->curve->nz);
  EXPECT_EQ(one->curve->area, two->curve->area);
  EXPECT_EQ(one->curve->key, two->curve->key);
  EXPECT_EQ(one->curve->triangle, two->curve->triangle);
  EXPECT_EQ(one->curve->reference_curvature, two->curve->reference_curvature);
}

TEST(Pipeline, ReportsStagesInOrder) {
  std::vector<std::string> stages;
  ExecutionContext context;
  context.on_progress = [&](std::string_view stage, double fraction) {
    EXPECT_GE(fraction, 0);
    EXPECT_LE(fraction, 1);
    if (stages.empty() || stages.back() != stage) stages.emplace_back(stage);
  };
  const std::string cube = curvecast::testing::to_off(curvecast::testing::cube());
  ASSERT_TRUE(preprocess({"shape.off", cube}, {.points = 100}, context).ok());
  EXPECT_THAT(stages, ::testing::ElementsAre("read", "repair", "cut", "parameterise", "curve", "map", "area"));
}

TEST(Pipeline, StopsAtEveryStageWhenCancelled) {
  const std::string off = curvecast::testing::to_off(curvecast::testing::torus(40, 20));
  for (const std::string_view last : {"read", "repair", "cut", "parameterise", "curve", "map", "area"}) {
    std::atomic<bool> cancel = false;
    ExecutionContext context;
    context.cancel = &cancel;
    context.on_progress = [&](std::string_view stage, double) { cancel = cancel || stage == last; };
    EXPECT_EQ(preprocess({"shape.off", off}, {.points = 2000}, context).status().code(), absl::StatusCode::kCancelled) << last;
  }
}

TEST(Pipeline, TellsWhatTheMeshCarriesAndWhatIsMissing) {
  const std::string file = "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n";
  const absl::StatusOr<MeshInfo> info = inspect_mesh({"a.obj", std::span<const char>(file.data(), file.size())});
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(info->format, "obj");
  EXPECT_THAT(info->attributes, ::testing::ElementsAre("colours", "uv", "materials"));
  EXPECT_THAT(info->warnings, ::testing::ElementsAre(HasSubstr("line 1: the material library 'a.mtl' is not there")));
}

/// The least cosine between a normal of the curve and the nearest of the faces' normals.
double least_cosine(const std::string& file, const PreprocessOptions& options, const char* name = "shape.off") {
  const absl::StatusOr<Preprocessed> made = preprocess({name, file}, options);
  EXPECT_TRUE(made.ok()) << made.status();
  if (!made.ok()) return std::nan("");
  const TriangleMesh& mesh = made->flattened->loaded.mesh;
  double least = 1;
  for (std::size_t l = 0; l < made->curve->size(); ++l) {
    double nearest = -1;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      nearest = std::max(nearest, made->curve->normal(l).cast<double>().dot(area_vector(mesh, f).normalized()));
    }
    least = std::min(least, nearest);
  }
  return least;
}

TEST(Pipeline, NormalsLeanOverEdgesAsTheAngleOfCreasesSays) {
  using namespace curvecast::testing;
  constexpr double kFlat = 0.9999;  // lengths are rounded
  const auto cosine = [](const PolygonSoup& soup, double degrees) {
    return least_cosine(to_off(soup), {.points = 500, .crease_degrees = degrees});
  };
  EXPECT_GT(least_cosine(to_off(cube()), {.points = 500}), kFlat) << "its edges are of 90 degrees";
  EXPECT_LT(cosine(cube(), 91), 0.9);
  const PolygonSoup twelve_sides = open_cylinder(2, 12);  // edges of 30 degrees
  EXPECT_LT(least_cosine(to_off(twelve_sides), {.points = 500}), 0.98);
  EXPECT_LT(cosine(twelve_sides, 31), 0.98);
  EXPECT_GT(cosine(twelve_sides, 29), kFlat);
  EXPECT_GT(cosine(twelve_sides, 20), kFlat);
  EXPECT_GT(cosine(icosphere(2), 0), kFlat);
  EXPECT_LT(cosine(icosphere(2), 180), 0.997);
}

TEST(Pipeline, EdgesAreSharpAsTheFileMeans) {
  using namespace curvecast::testing;
  // A ball of 80 facets, in one smoothing group or none.
  const auto ball = [](std::string_view groups) {
    std::string obj(groups);
    const PolygonSoup soup = icosphere(1);
    for (const Vec3d& p : soup.positions) absl::StrAppendFormat(&obj, "v %.17g %.17g %.17g\n", p.x(), p.y(), p.z());
    for (std::size_t i = 0; i < soup.indices.size(); i += 3) {
      absl::StrAppendFormat(&obj, "f %d %d %d\n", soup.indices[i] + 1, soup.indices[i + 1] + 1, soup.indices[i + 2] + 1);
    }
    return obj;
  };
  const auto least = [&](std::string_view groups, PreprocessOptions options) {
    return least_cosine(ball(groups), options, "ball.obj");
  };
  EXPECT_GT(least("s off\n", {.points = 500}), 0.9999);
  EXPECT_LT(least("s 1\n", {.points = 500}), 0.99);
  EXPECT_LT(least("", {.points = 500}), 0.99);
  EXPECT_LT(least("s off\n", {.points = 500, .crease_degrees = 40}), 0.99) << "who asks is asked";
  EXPECT_GT(least("s 1\n", {.points = 500, .crease_degrees = 0}), 0.9999);
}

TEST(Pipeline, RefusesOptionsOutOfRange) {
  const std::string off = curvecast::testing::to_off(curvecast::testing::cube());
  for (const PreprocessOptions& options :
       {PreprocessOptions{.points = 0}, {.points = kMaxPoints + 1}, {.omega = 0.5}, {.omega = 1e9}, {.omega = std::nan("")}}) {
    EXPECT_EQ(run(off, options).status().code(), absl::StatusCode::kInvalidArgument);
  }
  for (const double degrees : {-0.1, 180.1, 1e300, std::nan("")}) {
    const absl::Status refused = run(off, {.crease_degrees = degrees}).status();
    EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(refused.message()), HasSubstr("crease_degrees = "));
  }
}

TEST(Pipeline, NamesTheFileAtFault) {
  const absl::StatusOr<Preprocessed> result = run("OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n");
  EXPECT_EQ(result.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(result.status().message()), HasSubstr("shape.off"));
  EXPECT_THAT(std::string(result.status().message()), HasSubstr("degenerate"));
}

class RealMeshPipeline : public ::testing::TestWithParam<const char*> {};

TEST_P(RealMeshPipeline, GivesExactlyNPointsOnItsSurface) {
  const testing::RealMesh file = testing::real_mesh(GetParam());
  constexpr std::uint64_t kPoints = 50'000;
  const absl::StatusOr<Preprocessed> result = preprocess({file.name, file.bytes}, {.points = kPoints});
  ASSERT_TRUE(result.ok()) << result.status().message();
  EXPECT_EQ(result->report.flipped_triangles, 0u);
  EXPECT_LT(result->report.area_error, 0.005);
  EXPECT_GE(result->report.curve_vertices, 10 * kPoints);
  const absl::StatusOr<PointSet> points = resample(*result->curve, {.points = kPoints});
  ASSERT_TRUE(points.ok());
  ASSERT_EQ(points->size(), kPoints);
  const absl::StatusOr<PolygonSoup> soup = read_mesh({file.name, file.bytes});
  ASSERT_TRUE(soup.ok());
  const TriangleMesh mesh = curvecast::testing::make_mesh(*soup);
  const double tolerance = 1e-5 * result->report.mesh.box.diagonal();
  for (std::size_t i = 0; i < points->size(); ++i) {
    // Distance to the plane of the face that holds the point, and to the inside of its three sides.
    const Triangle& t = mesh.triangles[result->curve->triangle[points->vertices[i]]];
    const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const Vec3d p = points->origin + points->positions[i].cast<double>();
    const Vec3d normal = (b - a).cross(c - a).normalized();
    ASSERT_LT(std::abs((p - a).dot(normal)), tolerance);
    ASSERT_GT((b - a).cross(p - a).dot(normal) / (b - a).norm(), -tolerance);
    ASSERT_GT((c - b).cross(p - b).dot(normal) / (c - b).norm(), -tolerance);
    ASSERT_GT((a - c).cross(p - c).dot(normal) / (a - c).norm(), -tolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(Shared, RealMeshPipeline, ::testing::ValuesIn(testing::real_mesh_names()));

}  // namespace
}  // namespace curvecast
