#include "core/storage/surface_file.h"

#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <map>

#include "core/storage/section_file.h"
#include "tests/support/real_mesh.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace curvecast {
namespace {

using testing::bytes_of;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::write_file;
using Code = absl::StatusCode;

FlattenedMesh flattened(const PolygonSoup& soup) {
  absl::StatusOr<FlattenedMesh> result = flatten_mesh({"shape.off", testing::to_off(soup)}, {});
  EXPECT_TRUE(result.ok()) << result.status();
  return *std::move(result);
}

/// With one of everything that a mesh can carry.
FlattenedMesh adorned() {
  FlattenedMesh surface =
      flattened(testing::merged(testing::icosphere(1), testing::translated(testing::mobius_strip(12), {4, 0, 0})));
  MeshAttributes& attributes = surface.loaded.attributes;
  const std::size_t vertices = surface.loaded.mesh.vertex_count(), faces = surface.loaded.mesh.face_count();
  attributes.colours.assign(vertices, {1, 2, 3, 4});
  attributes.normals.assign(vertices, {0, 0, 1});
  attributes.scalars = {{"quality", std::vector<float>(vertices, 0.5f)}, {"", std::vector<float>(vertices, 2)}};
  attributes.uv.assign(3 * faces, {0.25f, 0.75f});
  attributes.face_colours.assign(faces, {5, 6, 7, 8});
  attributes.material_of_face.assign(faces, 2);
  attributes.material_of_face[1] = MeshAttributes::kNoMaterial;
  const auto image = std::make_shared<Image>(Image{2, 3, std::vector<std::uint8_t>(24, 9)});
  const auto other = std::make_shared<Image>(Image{1, 1, {1, 2, 3, 4}});
  attributes.materials = {{"plain", {1, 1, 1, 1}, nullptr}, {"wood", {2, 2, 2, 2}, image}, {"oak", {}, image}, {"", {}, other}};
  surface.loaded.info.warnings = {"a warning"};
  return surface;
}

TEST(SurfaceFile, BringsEverythingBack) {
  const TemporaryFolder folder;
  const FlattenedMesh surface = adorned();
  ASSERT_TRUE(save_surface(folder / "surface", surface).ok());
  const auto loaded = load_surface(folder / "surface");
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(loaded->loaded.mesh.positions, surface.loaded.mesh.positions);
  EXPECT_EQ(loaded->loaded.mesh.triangles, surface.loaded.mesh.triangles);
  EXPECT_EQ(loaded->loaded.mesh.twins, surface.loaded.mesh.twins);
  ASSERT_EQ(loaded->geometry.size(), surface.geometry.size());
  for (std::size_t v = 0; v < surface.geometry.size(); ++v) {
    ASSERT_EQ(loaded->geometry[v].direction_max, surface.geometry[v].direction_max) << "vertex " << v;
  }
  const MeshAttributes &a = loaded->loaded.attributes, &b = surface.loaded.attributes;
  EXPECT_EQ(a.colours, b.colours);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.uv, b.uv);
  EXPECT_EQ(a.face_colours, b.face_colours);
  EXPECT_EQ(a.material_of_face, b.material_of_face);
  ASSERT_EQ(a.scalars.size(), 2u);
  EXPECT_EQ(a.scalars[0].name, "quality");
  EXPECT_EQ(a.scalars[1].values, b.scalars[1].values);
  ASSERT_EQ(a.materials.size(), 4u);
  EXPECT_EQ(a.materials[0].texture, nullptr);
  EXPECT_EQ(a.materials[1].name, "wood");
  EXPECT_EQ(a.materials[1].colour, (Rgba8{2, 2, 2, 2}));
  EXPECT_EQ(a.materials[1].texture, a.materials[2].texture) << "shared, as before";
  EXPECT_EQ(a.materials[1].texture->rgba, b.materials[1].texture->rgba);
  EXPECT_EQ(a.materials[3].texture->width, 1);
  EXPECT_EQ(loaded->loaded.info.warnings, surface.loaded.info.warnings);
  EXPECT_EQ(loaded->report.discs, surface.report.discs);
  ASSERT_EQ(loaded->charts.size(), surface.charts.size());
  for (std::size_t c = 0; c < surface.charts.size(); ++c) {
    const Chart &x = loaded->charts[c], &y = surface.charts[c];
    EXPECT_EQ(x.disc.positions, y.disc.positions);
    EXPECT_EQ(x.disc.triangles, y.disc.triangles);
    EXPECT_EQ(x.disc.twins, y.disc.twins);
    EXPECT_EQ(x.disc.face_of, y.disc.face_of);
    EXPECT_EQ(x.disc.border, y.disc.border);
    EXPECT_EQ(x.uv, y.uv);
    EXPECT_EQ(x.parameterisation, y.parameterisation);
  }
}

TEST(SurfaceFile, TheCurveOnItIsTheSame) {
  const TemporaryFolder folder;
  using namespace testing;
  for (const PolygonSoup& soup :
       {disc(6, 20), torus(16, 10), perforated_slab(5, 3), open_cylinder(6, 12), mobius_strip(20), single_triangle(), cube()}) {
    const auto surface = std::make_shared<const FlattenedMesh>(flattened(soup));
    ASSERT_TRUE(save_surface(folder / "surface", *surface).ok());
    auto loaded = load_surface(folder / "surface");
    ASSERT_TRUE(loaded.ok()) << loaded.status();
    const PreprocessOptions options = {.points = 300};
    const auto before = lay_curve(surface, options);
    const auto after = lay_curve(std::make_shared<const FlattenedMesh>(*std::move(loaded)), options);
    ASSERT_TRUE(before.ok() && after.ok());
    EXPECT_EQ(before->curve->x, after->curve->x);
    EXPECT_EQ(before->curve->key, after->curve->key);
    EXPECT_EQ(before->curve->area, after->curve->area);
    EXPECT_EQ(before->report.distortion.max, after->report.distortion.max);
  }
}

TEST(SurfaceFile, NoticesDamage) {
  const TemporaryFolder folder;
  const std::string path = folder / "surface";
  ASSERT_TRUE(save_surface(path, adorned()).ok());
  const std::string good = bytes_of(path);
  for (std::size_t at = 0; at < good.size(); at += 1 + good.size() / 1500) {
    std::string bytes = good;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << at % 8));
    write_file(path, bytes);
    const Code code = load_surface(path).status().code();
    EXPECT_TRUE(code == Code::kDataLoss || code == Code::kFailedPrecondition) << at;
  }
  for (std::size_t size = 0; size < good.size(); size += 1 + good.size() / 300) {
    write_file(path, good.substr(0, size));
    EXPECT_EQ(load_surface(path).status().code(), Code::kDataLoss) << size;
  }
  EXPECT_EQ(load_surface(folder / "nowhere").status().code(), Code::kNotFound);
  ASSERT_TRUE(write_section_file(path, {"CURVE", 1}, {}).ok());
  EXPECT_EQ(load_surface(path).status().code(), Code::kFailedPrecondition);
}

TEST(SurfaceFile, RefusesAbsurdContentWithGoodChecksums) {
  using Spoil = std::function<void(FlattenedMesh&)>;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::map<std::string, Spoil> spoilers = {
      {"no vertex", [](auto& s) { s.loaded.mesh.positions.clear(); }},
      {"no face", [](auto& s) { s.loaded.mesh.triangles.clear(), s.loaded.mesh.twins.clear(); }},
      {"NaN vertex", [&](auto& s) { s.loaded.mesh.positions[3].y() = nan; }},
      {"absurd corner", [](auto& s) { s.loaded.mesh.triangles[2][1] = 4'000'000'000u; }},
      {"corner twice", [](auto& s) { s.loaded.mesh.triangles[2][1] = s.loaded.mesh.triangles[2][0]; }},
      {"too few twins", [](auto& s) { s.loaded.mesh.twins.pop_back(); }},
      {"absurd twin", [](auto& s) { s.loaded.mesh.twins[4] = 4'000'000'000u; }},
      {"one-sided twin", [](auto& s) { s.loaded.mesh.twins[0] = kNone; }},
      {"own twin", [](auto& s) { s.loaded.mesh.twins[0] = 0; }},
      {"few colours", [](auto& s) { s.loaded.attributes.colours.pop_back(); }},
      {"few normals", [](auto& s) { s.loaded.attributes.normals.pop_back(); }},
      {"few uv", [](auto& s) { s.loaded.attributes.uv.pop_back(); }},
      {"few face colours", [](auto& s) { s.loaded.attributes.face_colours.pop_back(); }},
      {"few values", [](auto& s) { s.loaded.attributes.scalars[1].values.pop_back(); }},
      {"absurd material", [](auto& s) { s.loaded.attributes.material_of_face[0] = 4; }},
      {"broken picture",
       [](auto& s) {
         s.loaded.attributes.materials[3].texture = std::make_shared<Image>(Image{2, 2, {1, 2, 3, 4}});
       }},
      {"negative picture",
       [](auto& s) {
         s.loaded.attributes.materials[3].texture = std::make_shared<Image>(Image{-1, -1, {1, 2, 3, 4}});
       }},
      {"no chart", [](auto& s) { s.charts.clear(); }},
      {"absurd parameterisation", [](auto& s) { s.charts[0].parameterisation = static_cast<Parameterisation>(7); }},
      {"empty disc", [](auto& s) { s.charts[0] = Chart(); }},
      {"absurd disc corner", [](auto& s) { s.charts[1].disc.triangles[0][0] = 1'000'000; }},
      {"absurd disc twin", [](auto& s) { s.charts[1].disc.twins[0] = 1'000'000; }},
      {"absurd face", [](auto& s) { s.charts[1].disc.face_of[0] = 1'000'000; }},
      {"few faces", [](auto& s) { s.charts[1].disc.face_of.pop_back(); }},
      {"few disc uv", [](auto& s) { s.charts[1].uv.pop_back(); }},
      {"uv out of the square", [](auto& s) { s.charts[1].uv[0].x() = 1.5; }},
      {"NaN uv", [&](auto& s) { s.charts[1].uv[0].x() = nan; }},
      {"flipped triangle",
       [](auto& s) {
         for (Vec2d& uv : s.charts[1].uv) uv.x() = 1 - uv.x();
       }},
      {"collapsed triangle",
       [](auto& s) {
         for (Vec2d& uv : s.charts[1].uv) uv.x() = 0;
       }},
      {"absurd border", [](auto& s) { s.charts[1].disc.border[0] = 1'000'000; }},
      {"border vertex twice", [](auto& s) { s.charts[1].disc.border[0] = s.charts[1].disc.border[1]; }},
      {"short border", [](auto& s) { s.charts[1].disc.border.resize(3); }},
      {"NaN area", [&](auto& s) { s.report.mesh.area = nan; }},
      {"infinite box", [](auto& s) { s.report.mesh.box = Box3d(); }},
  };
  const TemporaryFolder folder;
  const std::string path = folder / "surface";
  const FlattenedMesh good = adorned();
  ASSERT_TRUE(check_surface(good).ok()) << check_surface(good);
  for (const auto& [what, spoil] : spoilers) {
    FlattenedMesh surface = good;
    spoil(surface);
    ASSERT_TRUE(save_surface(path, surface).ok()) << what;
    const absl::Status status = load_surface(path).status();
    EXPECT_EQ(status.code(), Code::kDataLoss) << what << ": " << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(path)) << what;
  }
}

TEST(SurfaceFile, TakesARealMesh) {
  const testing::RealMesh file = testing::real_mesh("spot.obj");
  const auto surface = flatten_mesh({file.name, file.bytes}, {});
  ASSERT_TRUE(surface.ok()) << surface.status();
  const TemporaryFolder folder;
  ASSERT_TRUE(save_surface(folder / "surface", *surface).ok());
  const auto loaded = load_surface(folder / "surface");
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(loaded->charts[0].uv, surface->charts[0].uv);
  EXPECT_EQ(loaded->loaded.attributes.uv, surface->loaded.attributes.uv);
}

}  // namespace
}  // namespace curvecast
