#include "server/web/resources/query.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace curvecast::server {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

TEST(WebQuery, PartsAreDecodedAndKeepTheirOrder) {
  EXPECT_THAT(*parse_query("n=10&density=curvature:floor=0.2&density=expression:x%3E0+%2B+1&flag&=x"),
              ElementsAre(Pair("n", "10"), Pair("density", "curvature:floor=0.2"), Pair("density", "expression:x>0 + 1"),
                          Pair("flag", ""), Pair("", "x")));
  EXPECT_TRUE(parse_query("")->empty());
  EXPECT_TRUE(parse_query("&&")->empty());
}

TEST(WebQuery, RefusesWhatIsNoText) {
  for (const char* query : {"a=%", "a=%4", "a=%g0", "%ff=1", "a=%c3", "a=%ed%a0%80"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(parse_query(query).status())) << query;
  }
  std::string many;
  for (int i = 0; i < 257; ++i) many += "a=1&";
  EXPECT_TRUE(absl::IsInvalidArgument(parse_query(many).status()));
}

TEST(WebQuery, APlusInAPathIsAPlus) {
  EXPECT_EQ(*percent_decoded("a+b%20c", false), "a+b c");
  EXPECT_EQ(*percent_decoded("%C3%A4", false), "\xc3\xa4");
}

TEST(WebQuery, NamesInHeadersAreHarmless) {
  EXPECT_EQ(header_name_of("my \"mesh\"\r\n\xc3\xa4"), "my__mesh_____");
  EXPECT_EQ(header_name_of(""), "points");
  EXPECT_EQ(header_name_of(std::string(1000, 'a')).size(), 64u);
}

TEST(WebQuery, SaysWhichPageOfAList) {
  EXPECT_EQ(read_page_terms({})->size, 0u);
  EXPECT_EQ(read_page_terms({})->token, "");
  const auto terms = read_page_terms({{"page_token", "abc"}, {"page_size", "4294967295"}});
  ASSERT_TRUE(terms.ok()) << terms.status();
  EXPECT_EQ(terms->size, 4294967295u);
  EXPECT_EQ(terms->token, "abc");
  for (const char* size : {"", "x", "-1", "1.5", "4294967296"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(read_page_terms({{"page_size", size}}).status())) << size;
  }
  EXPECT_THAT(read_page_terms({{"page", "2"}}).status().message(), ::testing::HasSubstr("'page=2'"));
}

}  // namespace
}  // namespace curvecast::server
