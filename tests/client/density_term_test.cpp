#include "client/cli/density_term.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace curvecast::cli {
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

TEST(DensityTerm, NamesWhatIsThereInstead) {
  for (const char* text : {"attribute:heat", "brush:0,0,0,1,2", "distance", "screen", "frustum", "Uniform", "", "curvatur"}) {
    EXPECT_THAT(error_of(text), HasSubstr("there are: uniform, curvature, view")) << text;
  }
  EXPECT_THAT(error_of("brush:0,0,0,1,2"), HasSubstr("'brush'"));
}

TEST(DensityTerm, RefusesBadSettings) {
  EXPECT_THAT(error_of("curvature:kind=big"), HasSubstr("there are: gauss, mean, max"));
  EXPECT_THAT(error_of("curvature:s0=1"), HasSubstr("no 's0'"));
  EXPECT_THAT(error_of("view:exponent=1"), HasSubstr("no 'exponent'"));
  EXPECT_THAT(error_of("uniform:x=1"), HasSubstr("takes no settings"));
  for (const char* text : {"curvature:", "curvature:exponent", "curvature:exponent=", "curvature:=1", "curvature:exponent=1,",
                           "curvature:exponent=-1", "curvature:exponent=nan", "curvature:exponent=inf", "curvature:exponent=1x",
                           "curvature:floor=1.1", "curvature:floor=-0.1", "curvature:floor=0.1,floor=0.2", "view:s0=0",
                           "view:s0=-1", "view:s0=nan", "view:", "uniform:"}) {
    EXPECT_FALSE(error_of(text).empty()) << text;
  }
}

}  // namespace
}  // namespace curvecast::cli
