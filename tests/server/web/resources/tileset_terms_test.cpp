#include "server/web/resources/tileset_terms.h"

#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "server/web/resources/query.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;
using Query = WebResource::Query;

std::string error_of(const Query& query) { return std::string(read_tileset_query(query).status().message()); }

TEST(TilesetTerms, AreRead) {
  const auto terms = read_tileset_query({{"n", "5000"}, {"density", "curvature:floor=0.2"}, {"up", "z"}, {"glb", "quantised"}});
  ASSERT_TRUE(terms.ok()) << terms.status();
  EXPECT_EQ(terms->sample.points(), 5000u);
  EXPECT_EQ(terms->sample.sampler(), v1::SAMPLER_PROGRESSIVE);
  EXPECT_TRUE(terms->sample.encoding().has_raw());
  ASSERT_EQ(terms->sample.attributes_size(), 1);
  EXPECT_EQ(terms->sample.attributes(0), v1::POINT_ATTRIBUTE_RANK);
  EXPECT_TRUE(terms->sample.density(0).has_curvature());
  EXPECT_TRUE(terms->options.z_up);
  EXPECT_TRUE(terms->options.content.quantise);
  EXPECT_FALSE(terms->options.content.compress);
  const auto none = read_tileset_query({});
  ASSERT_TRUE(none.ok());
  EXPECT_FALSE(none->sample.has_points());
  EXPECT_TRUE(none->options.content.compress);
}

TEST(TilesetTerms, ErrorsNameThePart) {
  EXPECT_THAT(error_of({{"n", "many"}}), HasSubstr("'n=many': must be a number of points"));
  EXPECT_THAT(error_of({{"n", "-1"}}), HasSubstr("'n=-1'"));
  EXPECT_THAT(error_of({{"n", "1"}, {"n", "2"}}), HasSubstr("'n=2': n is given more than once"));
  for (const char* camera : {"frustum", "view", "screen", "distance", "picture"}) {
    EXPECT_THAT(error_of({{"density", camera}}), HasSubstr("depends on a camera")) << camera;
  }
  EXPECT_THAT(error_of({{"density", "frustum"}}), HasSubstr("'density=frustum': this density depends on a camera"));
  EXPECT_THAT(error_of({{"density", "curvatur"}}), HasSubstr("there are: uniform, curvature"));
  EXPECT_THAT(error_of({{"density", "brush:@/etc/passwd"}}), HasSubstr("command line only"));
  for (const char* name : {"seed", "camera", "pixel_error", "sampler", "points", "up"}) {
    EXPECT_THAT(error_of({{name, "1"}}), HasSubstr("is nothing that tiles have; there are: n, density")) << name;
  }
}

TEST(TilesetTerms, HaveOneSpelling) {
  const Query plain = {{"density", "curvature"}, {"n", "7"}, {"up", "y"}, {"glb", "meshopt"}};
  EXPECT_EQ(tileset_text(plain, 7).value(), "n=7&density=curvature");
  EXPECT_EQ(tileset_text({}, 9).value(), "n=9");
  const Query odd = {{"glb", "floats"}, {"density", "expression:x + y & \"\xc3\xa4%\""}, {"up", "z"}, {"density", "curvature"}};
  const std::string text = tileset_text(odd, 9).value();
  EXPECT_THAT(text, HasSubstr("n=9&density=expression:x%20%2b%20y"));
  const auto again = parse_query(text);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ((*again)[1].second, odd[1].second);
  EXPECT_EQ(tileset_text(*again, 9).value(), text);
  const absl::Status refused = tileset_text({{"density", std::string(4000, 'x')}}, 9).status();
  EXPECT_THAT(std::string(refused.message()), HasSubstr("density: its terms have 4009 bytes"));
}

TEST(TilesetTerms, AreAPartOfAddresses) {
  const TilesetAddress address{std::string(32, 'a'), "n=9&density=expression:x%20%2b%20y??~"};
  const std::string part = address.part();
  EXPECT_THAT(part, ::testing::MatchesRegex("[0-9a-f]{32}[.][A-Za-z0-9_-]+"));
  const auto read = read_tileset_address(part);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->digest, address.digest);
  EXPECT_EQ(read->text, address.text);
  const std::string digest(32, 'a');
  for (const std::string& other :
       {std::string(), std::string("x"), digest, absl::StrCat(digest, "."), absl::StrCat(part, "="), absl::StrCat(part, "!"),
        absl::StrCat(part, " "), absl::StrCat(std::string(32, 'A'), part.substr(32)), absl::StrCat(digest, "a.bj05"),
        absl::StrCat(digest, ".", std::string(10'000, 'a'))}) {
    EXPECT_EQ(read_tileset_address(other).status().code(), absl::StatusCode::kNotFound) << other;
  }
}

}  // namespace
}  // namespace curvecast::server
