#include "core/storage/curve_file.h"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>

#include "core/curve/curve_columns.h"
#include "core/curve/hilbert.h"
#include "core/pipeline/pipeline.h"
#include "core/sample/resample.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace curvecast {
namespace {

using testing::bytes_of;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::write_file;
using Code = absl::StatusCode;

/// Two components, one of them with colours and a scalar, as a PLY file has them.
std::string coloured_ply() {
  const PolygonSoup soup = testing::merged(testing::icosphere(1), testing::translated(testing::torus(12, 8), {4, 0, 0}));
  std::string vertices, faces;
  for (const Vec3d& p : soup.positions) {
    vertices += std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) +
                (p.z() > 0 ? " 255 0 0 1.5\n" : " 0 0 255 -2\n");
  }
  for (std::size_t f = 0; f < soup.polygon_count(); ++f) {
    const std::size_t begin = soup.polygon_begin[f], end = soup.polygon_begin[f + 1];
    faces += std::to_string(end - begin);
    for (std::size_t i = begin; i < end; ++i) faces += " " + std::to_string(soup.indices[i]);
    faces += "\n";
  }
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(soup.positions.size()) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar "
         "blue\nproperty float quality\nelement face " +
         std::to_string(soup.polygon_count()) + "\nproperty list uchar int vertex_indices\nend_header\n" + vertices + faces;
}

const SurfaceCurve& some_curve() {
  static const Preprocessed made = [] {
    const std::string ply = coloured_ply();
    absl::StatusOr<Preprocessed> result = preprocess({"some.ply", ply}, {.points = 100});
    EXPECT_TRUE(result.ok()) << result.status();
    auto curve = std::make_shared<SurfaceCurve>(*result->curve);
    // The pipeline may not carry scalars to the curve; the file does.
    curve->scalars.resize(2);
    for (ScalarColumn& scalar : curve->scalars) scalar.values.assign(curve->size(), 2.5f);
    curve->scalars[0].name = "quality";
    curve->scalars[1].values[7] = std::numeric_limits<float>::quiet_NaN();
    curve->revision = 3;
    curve->face_sources = FaceSources(Column<std::uint32_t>({FaceSources::code(1, false), FaceSources::code(0, true)}));
    curve->finish();
    result->curve = std::move(curve);
    return *std::move(result);
  }();
  return *made.curve;
}

template <typename T>
std::string raw(const T& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0])};
}

void expect_same(const SurfaceCurve& a, const SurfaceCurve& b) {
  std::map<std::string, std::string> columns;
  visit_columns(a, [&](const char* name, const auto& column, ColumnLength /*length*/) { columns[name] = raw(column); });
  visit_columns(
      b, [&](const char* name, const auto& column, ColumnLength /*length*/) { EXPECT_EQ(columns[name], raw(column)) << name; });
  ASSERT_EQ(a.scalars.size(), b.scalars.size());
  for (std::size_t i = 0; i < a.scalars.size(); ++i) {
    EXPECT_EQ(a.scalars[i].name, b.scalars[i].name);
    EXPECT_EQ(raw(a.scalars[i].values), raw(b.scalars[i].values));
  }
  EXPECT_EQ(raw(a.face_sources.codes()), raw(b.face_sources.codes()));
  EXPECT_FALSE(b.face_sources.codes().empty());
  EXPECT_EQ(a.disc_begin, b.disc_begin);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.box.min, b.box.min);
  EXPECT_EQ(a.box.max, b.box.max);
  EXPECT_EQ(a.reference_curvature, b.reference_curvature);
  EXPECT_EQ(a.total_area, b.total_area);
  EXPECT_EQ(a.max_points, b.max_points);
  EXPECT_EQ(a.revision, b.revision);
  EXPECT_EQ(a.byte_size(), b.byte_size());
}

class CurveFileTest : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  const std::string path_ = folder_ / "curve";
};

TEST_F(CurveFileTest, BringsEverythingBack) {
  const SurfaceCurve& curve = some_curve();
  ASSERT_EQ(curve.disc_begin.size(), 3u);
  ASSERT_FALSE(curve.colour.empty());
  ASSERT_TRUE(save_curve(path_, curve, "a note\0 with a zero").ok());
  for (const FileAccess access : {FileAccess::kMap, FileAccess::kCopy}) {
    const auto loaded = load_curve(path_, access);
    ASSERT_TRUE(loaded.ok()) << loaded.status();
    EXPECT_EQ(loaded->note, "a note\0 with a zero");
    expect_same(*loaded->curve, curve);
  }
}

TEST_F(CurveFileTest, TheSameCurveGivesTheSameBytes) {
  ASSERT_TRUE(save_curve(path_, some_curve()).ok());
  const auto loaded = load_curve(path_);
  ASSERT_TRUE(loaded.ok());
  ASSERT_TRUE(save_curve(folder_ / "again", *loaded->curve).ok());
  EXPECT_EQ(bytes_of(path_), bytes_of(folder_ / "again"));
}

TEST_F(CurveFileTest, ServesWhileItsFileIsReplacedAndRemoved) {
  ASSERT_TRUE(save_curve(path_, some_curve()).ok());
  const auto loaded = load_curve(path_);
  ASSERT_TRUE(loaded.ok());
  ASSERT_TRUE(save_curve(path_, *loaded->curve, "from what it replaces").ok());
  std::filesystem::remove(path_);
  ResampleOptions options;
  options.points = 50;
  options.density = {CurvatureTerm{}};
  const auto from_file = resample(*loaded->curve, options);
  const auto from_memory = resample(some_curve(), options);
  ASSERT_TRUE(from_file.ok() && from_memory.ok());
  EXPECT_EQ(from_file->positions, from_memory->positions);
}

TEST_F(CurveFileTest, NoticesDamageInEverySection) {
  ASSERT_TRUE(save_curve(path_, some_curve(), "note").ok());
  const std::string good = bytes_of(path_);
  // Every 64 bytes of the head and the table, then steps that reach every section many times.
  for (std::size_t at = 0; at < good.size(); at += at < 2048 ? 1 : 1 + good.size() / 1500) {
    std::string bytes = good;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << at % 8));
    write_file(path_, bytes);
    const Code code = load_curve(path_).status().code();
    EXPECT_TRUE(code == Code::kDataLoss || code == Code::kFailedPrecondition) << at;
  }
  for (std::size_t size = 0; size < good.size(); size += 1 + good.size() / 500) {
    write_file(path_, good.substr(0, size));
    EXPECT_EQ(load_curve(path_).status().code(), Code::kDataLoss) << size;
  }
}

TEST_F(CurveFileTest, RefusesAbsurdContentWithGoodChecksums) {
  using Spoil = std::function<void(SurfaceCurve&)>;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::map<std::string, Spoil> spoilers = {
      {"empty", [](auto& c) { c = SurfaceCurve(); }},
      {"a column too short", [](auto& c) { c.ny.resize(c.size() - 1); }},
      {"a column too long", [](auto& c) { c.level.assign(c.size() + 1, 0); }},
      {"a missing column", [](auto& c) { c.key.resize(0); }},
      {"half a colour", [](auto& c) { c.colour.assign(c.size() / 2, {}); }},
      {"half a scalar", [](auto& c) { c.scalars[1].values.assign(c.size() / 2, 0); }},
      {"no disc", [](auto& c) { c.disc_begin = {0}; }},
      {"no discs", [](auto& c) { c.disc_begin.clear(); }},
      {"discs not from 0", [](auto& c) { c.disc_begin[0] = 1; }},
      {"discs beyond the end", [](auto& c) { c.disc_begin.back() += 1; }},
      {"discs that go back",
       [](auto& c) {
         c.disc_begin = {0, 5, 3, static_cast<std::uint32_t>(c.size())};
       }},
      {"an empty disc",
       [](auto& c) {
         c.disc_begin = {0, 5, 5, static_cast<std::uint32_t>(c.size())};
       }},
      {"a key out of order", [](auto& c) { std::swap(c.key[10], c.key[11]); }},
      {"a key twice", [](auto& c) { c.key[11] = c.key[10]; }},
      {"an absurd key", [](auto& c) { c.key[c.size() - 1] = ~std::uint64_t{0}; }},
      {"a key between cells", [](auto& c) { c.key[0] += 1; }},
      {"a level too deep", [](auto& c) { c.level[c.size() - 1] = kMaxLevel + 1; }},
      {"the deepest of all levels", [](auto& c) { c.level[3] = 255; }},
      {"quads that overlap", [](auto& c) { c.level[3] = 0; }},
      {"NaN position", [](auto& c) { c.y[c.size() - 1] = kNan; }},
      {"infinite position", [](auto& c) { c.z[0] = -kInfinity; }},
      {"NaN curvature", [](auto& c) { c.curvature_max[5].code = 0x7fc1; }},
      {"infinite curvature", [](auto& c) { c.curvature_min[5].code = 0xff80; }},
      {"negative area", [](auto& c) { c.area[1] = -1; }},
      {"NaN area", [](auto& c) { c.area[1] = kNan; }},
      {"infinite area", [](auto& c) { c.area[1] = kInfinity; }},
      {"no total area", [](auto& c) { c.total_area = 0; }},
      {"NaN total area", [](auto& c) { c.total_area = kNan; }},
      {"NaN origin", [](auto& c) { c.origin.x() = kNan; }},
      {"empty box", [](auto& c) { c.box = Box3d(); }},
      {"box upside down", [](auto& c) { std::swap(c.box.min, c.box.max); }},
      {"negative curvature to compare with", [](auto& c) { c.reference_curvature[1] = -1; }},
      {"for no points", [](auto& c) { c.max_points = 0; }},
      {"before the first revision", [](auto& c) { c.revision = 0; }},
  };
  for (const auto& [what, spoil] : spoilers) {
    SurfaceCurve curve = some_curve();
    spoil(curve);
    EXPECT_EQ(check_curve(curve).code(), Code::kInvalidArgument) << what;
    ASSERT_TRUE(save_curve(path_, curve).ok()) << what;
    const absl::Status status = load_curve(path_).status();
    EXPECT_EQ(status.code(), Code::kDataLoss) << what;
    EXPECT_THAT(std::string(status.message()), HasSubstr(path_)) << what;
  }
}

TEST_F(CurveFileTest, RefusesOtherFiles) {
  EXPECT_EQ(load_curve(path_).status().code(), Code::kNotFound);
  ASSERT_TRUE(write_section_file(path_, {"SURFACE", 1}, {}).ok());
  EXPECT_EQ(load_curve(path_).status().code(), Code::kFailedPrecondition);
  ASSERT_TRUE(write_section_file(path_, {"CURVE", kCurveFileVersion + 1}, {}).ok());
  EXPECT_EQ(load_curve(path_).status().code(), Code::kFailedPrecondition);
  ASSERT_TRUE(write_section_file(path_, {"CURVE", kCurveFileVersion}, {}).ok());
  EXPECT_EQ(load_curve(path_).status().code(), Code::kDataLoss) << "no section at all";
}

}  // namespace
}  // namespace curvecast
