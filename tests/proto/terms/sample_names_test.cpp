#include "proto/terms/sample_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace curvecast::terms {
namespace {

using ::testing::HasSubstr;

TEST(SampleNames, MeanWhatTheApiHas) {
  EXPECT_EQ(*parse_sampler("equalised"), v1::SAMPLER_EQUALISED);
  EXPECT_EQ(*parse_sampler("progressive"), v1::SAMPLER_PROGRESSIVE);
  EXPECT_EQ(*parse_sequence("golden"), v1::SEQUENCE_GOLDEN_RATIO);
  EXPECT_EQ(*parse_sequence("vandercorput"), *parse_sequence("niederreiter"));
  EXPECT_EQ(*parse_attribute("surface"), v1::POINT_ATTRIBUTE_SURFACE);
  EXPECT_EQ(*parse_attribute("scalars"), v1::POINT_ATTRIBUTE_SCALARS);
}

TEST(SampleNames, SayWhatThereIsInstead) {
  EXPECT_THAT(parse_sampler("random").status().message(), HasSubstr("there are: equalised, progressive"));
  EXPECT_THAT(parse_sequence("").status().message(), HasSubstr("there are: jittered, regular"));
  EXPECT_THAT(parse_attribute("ranks").status().message(), HasSubstr("there is no attribute 'ranks'"));
}

}  // namespace
}  // namespace curvecast::terms
