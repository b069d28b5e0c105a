#include "core/storage/archive.h"

#include <gtest/gtest.h>

#include "core/storage/pipeline_archive.h"

namespace curvecast {
namespace {

PreprocessOptions some_options() {
  return {.points = 12'345,
          .omega = 7.5,
          .parameteriser = Parameteriser::kCgal,
          .mapper = Mapper::kIdBuffer,
          .area_element = AreaElement::kVoronoi,
          .density = {UniformTerm{}, CurvatureTerm{CurvatureKind::kMean, 2, 0.25}, ViewTerm{0.5}, DistanceTerm{1, 2, true},
                      FrustumTerm{}, ScreenTerm{}, AttributeTerm{"quality"}, BrushTerm{{{{1, 2, 3}, 4, 5, 0.25}}},
                      ExpressionTerm{"1 + x"}},
          .seed = 9,
          .chart_faces = 500,
          .crease_degrees = 25};
}

PreprocessReport some_report() {
  PreprocessReport report;
  report.mesh.format = "ply";
  report.mesh.box = {{-1, -2, -3}, {1, 2, 3}};
  report.mesh.attributes = {"colours", "scalar quality"};
  report.mesh.crease_degrees = 30;
  report.mesh.warnings = {"", "something was left out"};
  report.mesh.repairs.flipped_faces = 7;
  report.discs = 3;
  report.seconds.total = 1.25;
  return report;
}

TEST(Archive, BringsOptionsBack) {
  const std::string bytes = to_archive(some_options());
  PreprocessOptions back;
  ASSERT_TRUE(from_archive(bytes, back));
  EXPECT_EQ(to_archive(back), bytes);
  EXPECT_EQ(back.points, 12'345u);
  EXPECT_EQ(back.mapper, Mapper::kIdBuffer);
  EXPECT_EQ(back.crease_degrees, 25);
  ASSERT_EQ(back.density.size(), 9u);
  EXPECT_EQ(std::get<CurvatureTerm>(back.density[1]).floor, 0.25);
  EXPECT_EQ(std::get<AttributeTerm>(back.density[6]).name, "quality");
  EXPECT_EQ(std::get<BrushTerm>(back.density[7]).dabs.at(0).centre, Vec3d(1, 2, 3));
}

TEST(Archive, BringsReportsBack) {
  const std::string bytes = to_archive(some_report());
  PreprocessReport back;
  ASSERT_TRUE(from_archive(bytes, back));
  EXPECT_EQ(to_archive(back), bytes);
  EXPECT_EQ(back.mesh.warnings, some_report().mesh.warnings);
  EXPECT_EQ(back.mesh.repairs.flipped_faces, 7u);
}

TEST(Archive, EveryOptionCounts) {
  const std::string bytes = to_archive(some_options());
  const auto differs = [&](auto change) {
    PreprocessOptions options = some_options();
    change(options);
    return to_archive(options) != bytes;
  };
  EXPECT_TRUE(differs([](auto& o) { o.points = 1; }));
  EXPECT_TRUE(differs([](auto& o) { o.omega = 1; }));
  EXPECT_TRUE(differs([](auto& o) { o.parameteriser = Parameteriser::kLeastStretch; }));
  EXPECT_TRUE(differs([](auto& o) { o.mapper = Mapper::kExact; }));
  EXPECT_TRUE(differs([](auto& o) { o.area_element = AreaElement::kExact; }));
  EXPECT_TRUE(differs([](auto& o) { o.density.pop_back(); }));
  EXPECT_TRUE(differs([](auto& o) { o.seed = 0; }));
  EXPECT_TRUE(differs([](auto& o) { o.chart_faces = 0; }));
  EXPECT_TRUE(differs([](auto& o) { o.crease_degrees = 25.5; }));
  EXPECT_TRUE(differs([](auto& o) { o.crease_degrees.reset(); }));
  EXPECT_TRUE(differs([](auto& o) { std::get<ViewTerm>(o.density[2]).s0 = 0.75; }));
  EXPECT_TRUE(differs([](auto& o) { std::get<DistanceTerm>(o.density[3]).global = false; }));
  EXPECT_TRUE(differs([](auto& o) { std::get<DistanceTerm>(o.density[3]).fall = DistanceFall::kInverse; }));
  EXPECT_TRUE(differs([](auto& o) { std::get<AttributeTerm>(o.density[6]).name = "other"; }));
  EXPECT_TRUE(differs([](auto& o) { std::get<BrushTerm>(o.density[7]).dabs[0].falloff = 0.75; }));
  EXPECT_TRUE(differs([](auto& o) { std::get<ExpressionTerm>(o.density[8]).text = "1 + y"; }));
}

TEST(Archive, RefusesWhatIsCutOrTooLong) {
  for (const std::string& bytes : {to_archive(some_options()), to_archive(some_report())}) {
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      PreprocessOptions options;
      PreprocessReport report;
      EXPECT_FALSE(from_archive(bytes.substr(0, size), options) && from_archive(bytes.substr(0, size), report)) << size;
    }
  }
  PreprocessOptions options;
  EXPECT_FALSE(from_archive(to_archive(some_options()) + "x", options));
}

TEST(Archive, RefusesAbsurdValues) {
  PreprocessOptions options = some_options();
  options.mapper = static_cast<Mapper>(99);
  EXPECT_FALSE(from_archive(to_archive(options), options));
  std::vector<std::string> words;
  EXPECT_FALSE(from_archive(to_archive(std::uint64_t{1} << 60), words)) << "a count without its elements";
  std::string word;
  EXPECT_FALSE(from_archive(to_archive(~std::uint64_t{0}), word));
}

}  // namespace
}  // namespace curvecast
