#include "core/storage/surface_file.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include "core/pipeline/curve_surface.h"
#include "core/progressive/grow_ranks.h"
#include "core/refine/refine.h"
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

/// The surface as a file has it.
std::shared_ptr<const CurveBase> based(FlattenedMesh surface) {
  return *curve_base(std::make_shared<const FlattenedMesh>(std::move(surface)));
}

/// What is wrong with a file, whenever that shows.
absl::Status status_of(const std::string& path) {
  const auto opened = open_surface(path);
  if (!opened.ok()) return opened.status();
  const bool is_sound = (*opened)->is_all_sound();
  EXPECT_EQ(is_sound, (*opened)->status().ok());
  return (*opened)->status();
}

MATCHER_P(HasSame, expected, "") { return std::ranges::equal(arg, expected); }

TEST(SurfaceFile, IsOnlyWhoseNoteIsAskedFor) {
  const TemporaryFolder folder;
  ASSERT_TRUE(save_surface(folder / "surface", *based(adorned()), "mine").ok());
  EXPECT_TRUE(open_surface(folder / "surface", "mine").ok());
  for (const char* note : {"", "min", "yours"}) {
    const absl::Status status = open_surface(folder / "surface", note).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << note;
    EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr("another"));
  }
}

TEST(SurfaceFile, BringsEverythingBack) {
  const TemporaryFolder folder;
  const auto surface = based(adorned());
  ASSERT_TRUE(save_surface(folder / "surface", *surface).ok());
  const auto loaded = open_surface(folder / "surface");
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  ASSERT_TRUE((*loaded)->is_all_sound()) << (*loaded)->status();
  EXPECT_TRUE(surface->is_in_memory());
  EXPECT_FALSE((*loaded)->is_in_memory());
  EXPECT_EQ((*loaded)->byte_size(), surface->byte_size());
  const SurfaceData &x = (*loaded)->data, &y = surface->data;
  EXPECT_THAT(x.mesh.positions, HasSame(y.mesh.positions));
  EXPECT_THAT(x.mesh.triangles, HasSame(y.mesh.triangles));
  ASSERT_EQ(x.geometry.size(), y.geometry.size());
  for (std::size_t v = 0; v < y.geometry.size(); ++v) {
    ASSERT_EQ(x.geometry[v].normal, y.geometry[v].normal) << "vertex " << v;
    ASSERT_EQ(x.geometry[v].curvature_max, y.geometry[v].curvature_max) << "vertex " << v;
    ASSERT_EQ(x.geometry[v].direction_max, y.geometry[v].direction_max) << "vertex " << v;
  }
  ASSERT_EQ(x.creases.faces.size(), y.creases.faces.size());
  ASSERT_EQ(x.creases.normals.size(), y.creases.normals.size());
  EXPECT_THAT(x.borders, HasSame(y.borders));
  EXPECT_FALSE(y.borders.empty());
  ASSERT_EQ(x.scalars.size(), 2u);
  EXPECT_THAT(x.scalars[1], HasSame(y.scalars[1]));
  ASSERT_NE(x.colour, nullptr);
  const ColourView &a = x.colour->source(), &b = y.colour->source();
  EXPECT_THAT(a.colours, HasSame(b.colours));
  EXPECT_THAT(a.uv, HasSame(b.uv));
  EXPECT_THAT(a.face_colours, HasSame(b.face_colours));
  EXPECT_THAT(a.material_of_face, HasSame(b.material_of_face));
  ASSERT_EQ(a.materials.size(), 4u);
  EXPECT_EQ(a.materials[0].texture, nullptr);
  EXPECT_EQ(a.materials[1].name, "wood");
  EXPECT_EQ(a.materials[1].colour, (Rgba8{2, 2, 2, 2}));
  EXPECT_EQ(a.materials[1].texture, a.materials[2].texture) << "shared, as before";
  EXPECT_EQ(a.materials[1].texture->rgba, b.materials[1].texture->rgba);
  EXPECT_EQ(a.materials[3].texture->width, 1);
  EXPECT_EQ((*loaded)->triangle_of, surface->triangle_of);
  ASSERT_EQ((*loaded)->charts.size(), surface->charts.size());
  for (std::size_t c = 0; c < surface->charts.size(); ++c) {
    const BaseChart &of_file = (*loaded)->charts[c], &chart = surface->charts[c];
    EXPECT_THAT(of_file.positions, HasSame(chart.positions));
    EXPECT_THAT(of_file.triangles, HasSame(chart.triangles));
    EXPECT_THAT(of_file.twins, HasSame(chart.twins));
    EXPECT_THAT(of_file.face_of, HasSame(chart.face_of));
    EXPECT_THAT(of_file.uv, HasSame(chart.uv));
    EXPECT_EQ(of_file.kinds, chart.kinds);
    EXPECT_EQ(of_file.fills_square, chart.fills_square);
  }
}

TEST(SurfaceFile, CreasesComeBack) {
  const TemporaryFolder folder;
  const auto surface = based(flattened(testing::cube()));
  ASSERT_FALSE(surface->data.creases.faces.empty());
  ASSERT_TRUE(save_surface(folder / "surface", *surface).ok());
  const auto loaded = open_surface(folder / "surface");
  ASSERT_TRUE(loaded.ok() && (*loaded)->is_all_sound()) << loaded.status();
  for (std::uint32_t f = 0; f < surface->triangle_of.size(); ++f) {
    const CreaseFace *const x = (*loaded)->data.crease_of(f), *const y = surface->data.crease_of(f);
    ASSERT_EQ(x == nullptr, y == nullptr);
    if (y == nullptr) continue;
    EXPECT_EQ(x->normals, y->normals);
    EXPECT_EQ((*loaded)->data.creases.normals[x->normals[0]].normal, surface->data.creases.normals[y->normals[0]].normal);
  }
}

TEST(SurfaceFile, PlacesAndFinerCurvesOnItAreTheSame) {
  const TemporaryFolder folder;
  using namespace testing;
  for (const PolygonSoup& soup :
       {disc(6, 20), torus(16, 10), perforated_slab(5, 3), open_cylinder(6, 12), mobius_strip(20), single_triangle(), cube()}) {
    const auto made = lay_curve(std::make_shared<const FlattenedMesh>(flattened(soup)), {.points = 300});
    ASSERT_TRUE(made.ok()) << made.status();
    const auto in_memory = *curve_base(made->flattened);
    ASSERT_TRUE(save_surface(folder / "surface", *in_memory).ok());
    const auto mapped = open_surface(folder / "surface");
    ASSERT_TRUE(mapped.ok()) << mapped.status();
    const SurfaceCurve& curve = *made->curve;
    const std::vector<double> parts = {0.1, 0.4, 0.9};
    for (std::size_t l = 0; l < curve.size(); l += 7) {
      std::vector<SurfacePlace> x(3), y(3);
      LeafSurface(in_memory, made->curve).find(l, parts, 0.01, x);
      LeafSurface(*mapped, made->curve).find(l, parts, 0.01, y);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_THAT(x[i].position, ::testing::ElementsAreArray(y[i].position));
        EXPECT_THAT(x[i].normal, ::testing::ElementsAreArray(y[i].normal));
        EXPECT_EQ(x[i].face, y[i].face);
      }
    }
    const std::vector<CurveDemand> demands = {{2'000, {}}};
    const auto before = refine(*in_memory, curve, demands, {}), after = refine(**mapped, curve, demands, {});
    ASSERT_TRUE(before.ok() && after.ok()) << before.status() << after.status();
    ASSERT_NE(before->curve, nullptr);
    EXPECT_EQ(before->curve->x, after->curve->x);
    EXPECT_EQ(before->curve->key, after->curve->key);
    EXPECT_EQ(before->curve->area, after->curve->area);
  }
}

TEST(SurfaceFile, ReadsOnlyTheChartsThatAreAskedFor) {
  const TemporaryFolder folder;
  const std::string path = folder / "surface";
  const PolygonSoup balls = testing::merged(testing::icosphere(5), testing::translated(testing::icosphere(5), {4, 0, 0}));
  const auto made = lay_curve(std::make_shared<const FlattenedMesh>(flattened(balls)), {.points = 300});
  ASSERT_TRUE(made.ok()) << made.status();
  ASSERT_EQ(made->report.discs, 2u);
  ASSERT_TRUE(save_surface(path, **curve_base(made->flattened)).ok());
  // A byte of the second disc's places in the square, which the first has nothing to do with.
  std::string bytes = bytes_of(path);
  const auto& uv = made->flattened->charts[1].uv;
  const std::string_view value(reinterpret_cast<const char*>(&uv[uv.size() / 2]), sizeof(Vec2d));
  const std::size_t at = bytes.find(value);
  ASSERT_NE(at, std::string::npos);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  write_file(path, bytes);
  int told = 0;
  const auto mapped = open_surface(path, {}, [&](const absl::Status& status) {
    ++told;
    EXPECT_EQ(status.code(), Code::kDataLoss);
  });
  ASSERT_TRUE(mapped.ok()) << mapped.status();
  const LeafSurface leaves(*mapped, made->curve);
  std::vector<SurfacePlace> places(1);
  leaves.find(0, std::vector<double>{0.5}, 0.1, places);
  EXPECT_TRUE(leaves.status().ok()) << leaves.status();
  EXPECT_LT(places[0].face, balls.polygon_count() / 2);  // of the first ball
  const auto last = static_cast<std::uint32_t>(made->curve->size() - 1);
  for (int i = 0; i < 2; ++i) {
    leaves.find_even(std::vector<LeafPart>{{last, 0.5}}, places);
    EXPECT_EQ(leaves.status().code(), Code::kDataLoss);
    leaves.find(last, std::vector<double>{0.5}, 0.1, places);
  }
  EXPECT_EQ(told, 1);
  const std::vector<CurveDemand> demands = {{2'000, {}}};
  EXPECT_EQ(refine(**mapped, *made->curve, demands, {}).status().code(), Code::kDataLoss);
  EXPECT_EQ(RankGrower::make(std::make_shared<const LeafSurface>(*mapped, made->curve), {.level = kChunkLevels}).status().code(),
            Code::kDataLoss);
}

TEST(SurfaceFile, NoticesDamage) {
  const TemporaryFolder folder;
  const std::string path = folder / "surface";
  ASSERT_TRUE(save_surface(path, *based(adorned())).ok());
  const std::string good = bytes_of(path);
  for (std::size_t at = 0; at < good.size(); at += 1 + good.size() / 1500) {
    std::string bytes = good;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << at % 8));
    write_file(path, bytes);
    const Code code = status_of(path).code();
    EXPECT_TRUE(code == Code::kDataLoss || code == Code::kFailedPrecondition) << at;
  }
  for (std::size_t size = 0; size < good.size(); size += 1 + good.size() / 300) {
    write_file(path, good.substr(0, size));
    EXPECT_EQ(status_of(path).code(), Code::kDataLoss) << size;
  }
  EXPECT_EQ(status_of(folder / "nowhere").code(), Code::kNotFound);
  ASSERT_TRUE(write_section_file(path, {"CURVE", 1}, {}).ok());
  EXPECT_EQ(status_of(path).code(), Code::kFailedPrecondition);
}

/// A surface of which parts can be spoilt before it is saved: all that it looks at is here.
struct Spoilable {
  explicit Spoilable(FlattenedMesh mesh) : surface(std::move(mesh)), colour(surface.loaded.mesh, surface.loaded.attributes) {
    creases = surface.creases;
    const CurveBase good(data(), surface.charts);
    for (const BaseChart& chart : good.charts) kinds.emplace_back(chart.kinds.begin(), chart.kinds.end());
    triangle_of.assign(good.triangle_of.begin(), good.triangle_of.end());
  }

  /// Without computing anything of it: it may be spoilt.
  SurfaceData data() const {
    SurfaceData out;
    out.mesh = surface.loaded.mesh;
    out.geometry = surface.geometry;
    for (const ScalarAttribute& scalar : surface.loaded.attributes.scalars) out.scalars.emplace_back(scalar.values);
    out.colour = &colour;
    out.creases = creases;
    out.borders = surface.borders;
    return out;
  }
  absl::Status save(const std::string& path) const {
    std::vector<BaseChart> charts;
    for (std::size_t c = 0; c < surface.charts.size(); ++c) {
      charts.push_back({ChartView(surface.charts[c]), Column<std::uint8_t>(std::span<const std::uint8_t>(kinds[c])), true});
    }
    return save_surface(path,
                        CurveBase(data(), std::move(charts), Column<std::uint32_t>(std::span<const std::uint32_t>(triangle_of)),
                                  [](std::size_t /*disc*/) { return absl::OkStatus(); }));
  }

  FlattenedMesh surface;
  SurfaceColour colour;
  std::vector<std::vector<std::uint8_t>> kinds;
  std::vector<std::uint32_t> triangle_of;
  CreaseNormals creases;
};

TEST(SurfaceFile, RefusesAbsurdContentWithGoodChecksums) {
  using Spoil = std::function<void(Spoilable&)>;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto mesh = [](Spoilable& s) -> TriangleMesh& { return s.surface.loaded.mesh; };
  const auto chart = [](Spoilable& s) -> Chart& { return s.surface.charts[1]; };
  const std::map<std::string, Spoil> spoilers = {
      {"NaN vertex", [&](auto& s) { mesh(s).positions[3].y() = nan; }},
      {"absurd corner", [&](auto& s) { mesh(s).triangles[2][1] = 4'000'000'000u; }},
      {"few geometry", [](auto& s) { s.surface.geometry.pop_back(); }},
      {"few values", [](auto& s) { s.surface.loaded.attributes.scalars[1].values.pop_back(); }},
      {"few triangles of faces", [](auto& s) { s.triangle_of.pop_back(); }},
      {"absurd triangle of a face", [](auto& s) { s.triangle_of[0] = 1'000'000; }},
      {"few kinds", [](auto& s) { s.kinds[1].pop_back(); }},
      {"crease of no face",
       [](auto& s) {
         s.creases.faces = {{5, {kNone, kNone, kNone}}, {4, {kNone, kNone, kNone}}};
       }},
      {"border of no face", [](auto& s) { s.surface.borders = {4'000'000'000u}; }},
      {"borders in any order",
       [](auto& s) {
         s.surface.borders = {5, 4};
       }},
      {"crease without a normal",
       [](auto& s) {
         s.creases.faces = {{5, {1'000, kNone, kNone}}};
       }},
      {"no chart", [](auto& s) { s.surface.charts.clear(); }},
      {"empty disc", [&](auto& s) { chart(s) = Chart(); }},
      {"NaN disc vertex", [&](auto& s) { chart(s).disc.positions[3].y() = nan; }},
      {"absurd disc corner", [&](auto& s) { chart(s).disc.triangles[0][0] = 1'000'000; }},
      {"absurd disc twin", [&](auto& s) { chart(s).disc.twins[0] = 1'000'000; }},
      {"one-sided twin",
       [&](auto& s) {
         auto& twins = chart(s).disc.twins;
         *std::find_if(twins.begin(), twins.end(), [](std::uint32_t t) { return t != kNone; }) = kNone;
       }},
      {"own twin", [&](auto& s) { chart(s).disc.twins[0] = 0; }},
      {"few twins", [&](auto& s) { chart(s).disc.twins.pop_back(); }},
      {"absurd face", [&](auto& s) { chart(s).disc.face_of[0] = 1'000'000; }},
      {"few faces", [&](auto& s) { chart(s).disc.face_of.pop_back(); }},
      {"few disc uv", [&](auto& s) { chart(s).uv.pop_back(); }},
      {"uv out of the square", [&](auto& s) { chart(s).uv[0].x() = 1.5; }},
      {"NaN uv", [&](auto& s) { chart(s).uv[0].x() = nan; }},
      {"flipped triangle",
       [&](auto& s) {
         for (Vec2d& uv : chart(s).uv) uv.x() = 1 - uv.x();
       }},
      {"collapsed triangle",
       [&](auto& s) {
         for (Vec2d& uv : chart(s).uv) uv.x() = 0;
       }},
  };
  const TemporaryFolder folder;
  const std::string path = folder / "surface";
  ASSERT_TRUE(Spoilable(adorned()).save(path).ok());
  ASSERT_TRUE(status_of(path).ok()) << status_of(path);
  for (const auto& [what, spoil] : spoilers) {
    Spoilable surface(adorned());
    spoil(surface);
    ASSERT_TRUE(surface.save(path).ok()) << what;
    const absl::Status status = status_of(path);
    EXPECT_EQ(status.code(), Code::kDataLoss) << what << ": " << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(path)) << what;
  }
}

TEST(SurfaceFile, RefusesAbsurdColoursWithGoodChecksums) {
  using Spoil = std::function<void(MeshAttributes&)>;
  const std::map<std::string, Spoil> spoilers = {
      {"few colours", [](auto& a) { a.colours.pop_back(); }},
      {"few uv", [](auto& a) { a.uv.pop_back(); }},
      {"few face colours", [](auto& a) { a.face_colours.pop_back(); }},
      {"few materials of faces", [](auto& a) { a.material_of_face.pop_back(); }},
  };
  const TemporaryFolder folder;
  const std::string path = folder / "surface";
  for (const auto& [what, spoil] : spoilers) {
    FlattenedMesh surface = adorned();
    spoil(surface.loaded.attributes);
    ASSERT_TRUE(save_surface(path, *based(std::move(surface))).ok()) << what;
    EXPECT_EQ(status_of(path).code(), Code::kDataLoss) << what;
  }
}

TEST(SurfaceFile, TakesARealMesh) {
  const testing::RealMesh file = testing::real_mesh("spot.obj");
  absl::StatusOr<FlattenedMesh> made = flatten_mesh({file.name, file.bytes}, {});
  ASSERT_TRUE(made.ok()) << made.status();
  const auto surface = based(*std::move(made));
  const TemporaryFolder folder;
  ASSERT_TRUE(save_surface(folder / "surface", *surface).ok());
  const auto loaded = open_surface(folder / "surface");
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  ASSERT_TRUE((*loaded)->is_all_sound()) << (*loaded)->status();
  EXPECT_THAT((*loaded)->charts[0].uv, HasSame(surface->charts[0].uv));
}

}  // namespace
}  // namespace curvecast
