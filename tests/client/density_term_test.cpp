#include "client/cli/density_term.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

namespace curvecast::cli {
namespace {

using ::testing::HasSubstr;

TEST(CliDensityTerm, ABrushMayBeAFile) {
  const std::string path = ::testing::TempDir() + "dabs.txt";
  std::ofstream(path) << "0,0,1,0.2,4\n# no dab\n1 2 3 0.5 6 0.1\n";
  const auto term = parse_density_term("brush:@" + path);
  ASSERT_TRUE(term.ok()) << term.status();
  ASSERT_EQ(term->brush().strokes_size(), 2);
  EXPECT_EQ(term->brush().strokes(1).centre().y(), 2);
  std::ofstream(path) << "0,0,1,0.2,4\n1 2 3\n";
  EXPECT_THAT(parse_density_term("brush:@" + path).status().message(),
              HasSubstr(path + ", line 2: brush: '1,2,3' has 3 numbers"));
  EXPECT_THAT(parse_density_term("brush:@" + path + ".missing").status().message(), HasSubstr("cannot be read"));
}

TEST(CliDensityTerm, TermsAreAppendedInOrder) {
  v1::SampleRequest request;
  ASSERT_TRUE(add_density_terms({"uniform", "view:s0=0.5"}, request.mutable_density()).ok());
  ASSERT_EQ(request.density_size(), 2);
  EXPECT_EQ(request.density(1).view().s0(), 0.5);
  EXPECT_FALSE(add_density_terms({"blob"}, request.mutable_density()).ok());
}

}  // namespace
}  // namespace curvecast::cli
