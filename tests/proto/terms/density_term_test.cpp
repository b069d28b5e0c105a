#include "proto/terms/density_term.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace curvecast::terms {
namespace {

using ::testing::HasSubstr;

std::string error_of(const std::string& text) {
  const absl::Status status = parse_density_term(text).status();
  EXPECT_TRUE(absl::IsInvalidArgument(status)) << text;
  return std::string(status.message());
}

TEST(DensityTerm, ReadsTermsWithoutSettings) {
  EXPECT_TRUE(parse_density_term("uniform")->has_uniform());
  const auto view = parse_density_term("view");
  ASSERT_TRUE(view.ok() && view->has_view());
  EXPECT_FALSE(view->view().has_s0());
  const auto curvature = parse_density_term("curvature");
  ASSERT_TRUE(curvature.ok() && curvature->has_curvature());
  EXPECT_EQ(curvature->curvature().kind(), v1::CURVATURE_KIND_UNSPECIFIED);
  EXPECT_FALSE(curvature->curvature().has_exponent());
  EXPECT_FALSE(curvature->curvature().has_floor());
}

TEST(DensityTerm, ReadsSettingsInAnyOrder) {
  const auto term = parse_density_term("curvature:floor=0,kind=mean,exponent=2.5");
  ASSERT_TRUE(term.ok()) << term.status();
  EXPECT_EQ(term->curvature().kind(), v1::CURVATURE_KIND_MEAN);
  EXPECT_EQ(term->curvature().exponent(), 2.5);
  EXPECT_TRUE(term->curvature().has_floor());
  EXPECT_EQ(term->curvature().floor(), 0);
  EXPECT_EQ(parse_density_term("curvature:kind=gauss")->curvature().kind(), v1::CURVATURE_KIND_GAUSS);
  EXPECT_EQ(parse_density_term("curvature:kind=max")->curvature().kind(), v1::CURVATURE_KIND_MAX);
  EXPECT_EQ(parse_density_term("view:s0=0.25")->view().s0(), 0.25);
}

TEST(DensityTerm, ReadsWhatHasAFormOfItsOwn) {
  EXPECT_EQ(parse_density_term("attribute:heat, of: all")->attribute().name(), "heat, of: all");
  EXPECT_EQ(parse_density_term("expression:min(x, y) == 0 ? 1 : 2")->expression().text(), "min(x, y) == 0 ? 1 : 2");
  const auto brush = parse_density_term("brush:1,-2,3e1,0.5,0");
  ASSERT_TRUE(brush.ok()) << brush.status();
  EXPECT_EQ(brush->brush().strokes(0).centre().x(), 1);
  EXPECT_EQ(brush->brush().strokes(0).centre().y(), -2);
  EXPECT_EQ(brush->brush().strokes(0).centre().z(), 30);
  EXPECT_EQ(brush->brush().strokes(0).radius(), 0.5);
  EXPECT_EQ(brush->brush().strokes(0).factor(), 0);
  EXPECT_FALSE(brush->brush().strokes(0).has_falloff());
  EXPECT_EQ(parse_density_term("brush:1,2,3,4,5,0.25")->brush().strokes(0).falloff(), 0.25);
  const auto paint = parse_density_term("brush:1,2,3,4,5;6,7,8,9,10,1");
  ASSERT_TRUE(paint.ok()) << paint.status();
  ASSERT_EQ(paint->brush().strokes_size(), 2);
  EXPECT_EQ(paint->brush().strokes(1).centre().z(), 8);
  EXPECT_TRUE(parse_density_term("screen")->has_screen());
  EXPECT_TRUE(parse_density_term("picture")->has_picture());
  EXPECT_TRUE(parse_density_term("frustum")->has_frustum());
}

TEST(DensityTerm, ReadsDistancesWithAndWithoutKeys) {
  const auto plain = parse_density_term("distance");
  ASSERT_TRUE(plain.ok() && plain->has_distance());
  EXPECT_EQ(plain->distance().near(), 0);
  for (const char* text : {"distance:2,5", "distance:near=2,far=5", "distance:far=5,near=2", "distance:2,far=5"}) {
    const auto term = parse_density_term(text);
    ASSERT_TRUE(term.ok()) << term.status();
    EXPECT_EQ(term->distance().near(), 2) << text;
    EXPECT_EQ(term->distance().far(), 5) << text;
    EXPECT_FALSE(term->distance().global()) << text;
  }
  const auto global = parse_density_term("distance:near=2,global");
  ASSERT_TRUE(global.ok()) << global.status();
  EXPECT_TRUE(global->distance().global());
  EXPECT_EQ(global->distance().far(), 0);
  const auto linear = parse_density_term("distance:2,5,global=linear");
  ASSERT_TRUE(linear.ok()) << linear.status();
  EXPECT_EQ(linear->distance().fall(), v1::DISTANCE_FALL_LINEAR);
}

TEST(DensityTerm, ReadsFilesOnlyWhereItMay) {
  const FileReader read = [](const std::string& path) -> absl::StatusOr<std::string> {
    if (path == "empty") return "# none\n\n";
    if (path != "dabs") return absl::InvalidArgumentError("the file '" + path + "' cannot be read");
    return "0,0,1,0.2,4\n  1 2 3 0.5 6 0.1 # paint\r\n";
  };
  const auto brush = parse_density_term("brush:@dabs", read);
  ASSERT_TRUE(brush.ok()) << brush.status();
  ASSERT_EQ(brush->brush().strokes_size(), 2);
  EXPECT_EQ(brush->brush().strokes(1).falloff(), 0.1);
  EXPECT_EQ(parse_density_term("brush:@empty", read)->brush().strokes_size(), 0);
  EXPECT_THAT(parse_density_term("brush:@other", read).status().message(), HasSubstr("brush: the file 'other' cannot be read"));
  EXPECT_THAT(error_of("brush:@dabs"), HasSubstr("on a command line only"));
}

TEST(DensityTerm, KnowsWhatLooksFromACamera) {
  for (const char* text : {"view", "screen", "frustum", "distance"})
    EXPECT_TRUE(is_camera_term(*parse_density_term(text))) << text;
  for (const char* text : {"uniform", "curvature", "attribute:a", "brush:0,0,0,1,2", "expression:1"}) {
    EXPECT_FALSE(is_camera_term(*parse_density_term(text))) << text;
  }
}

TEST(DensityTerm, NamesWhatIsThereInstead) {
  for (const char* text : {"Uniform", "", "curvatur", "blob:1"}) {
    EXPECT_THAT(
        error_of(text),
        HasSubstr("there are: uniform, curvature, attribute, brush, expression, view, screen, frustum, picture, distance"))
        << text;
  }
  EXPECT_THAT(error_of("blob:1"), HasSubstr("'blob'"));
}

TEST(DensityTerm, RefusesBadSettings) {
  EXPECT_THAT(error_of("curvature:kind=big"), HasSubstr("there are: gauss, mean, max"));
  EXPECT_THAT(error_of("curvature:s0=1"), HasSubstr("no 's0'"));
  EXPECT_THAT(error_of("view:exponent=1"), HasSubstr("no 'exponent'"));
  EXPECT_THAT(error_of("uniform:x=1"), HasSubstr("takes no settings"));
  for (const char* text : {"curvature:",
                           "curvature:exponent",
                           "curvature:exponent=",
                           "curvature:=1",
                           "curvature:exponent=1,",
                           "curvature:exponent=-1",
                           "curvature:exponent=nan",
                           "curvature:exponent=inf",
                           "curvature:exponent=1x",
                           "curvature:floor=1.1",
                           "curvature:floor=-0.1",
                           "curvature:floor=0.1,floor=0.2",
                           "view:s0=0",
                           "view:s0=-1",
                           "view:s0=nan",
                           "view:",
                           "uniform:",
                           "screen:",
                           "frustum:x=1",
                           "attribute",
                           "attribute:",
                           "expression",
                           "expression:",
                           "brush",
                           "brush:",
                           "brush:1,2,3,4",
                           "brush:1,2,3,4,5,0.5,7",
                           "brush:1,2,3,0,5",
                           "brush:1,2,3,-1,5",
                           "brush:1,2,3,4,-5",
                           "brush:1,2,3,4,2000000",
                           "brush:1,2,3,4,5,2",
                           "brush:1,nan,3,4,5",
                           "brush:1,,3,4,5",
                           "distance:",
                           "distance:-1",
                           "distance:5,2",
                           "distance:1,2,3",
                           "distance:near=1,near=2",
                           "distance:global=1",
                           "distance:1,global=linear",
                           "distance:middle=1",
                           "distance:nan"}) {
    EXPECT_FALSE(error_of(text).empty()) << text;
  }
}

}  // namespace
}  // namespace curvecast::terms
