#include "server/web/web_origin.h"

#include <gtest/gtest.h>

namespace curvecast::server {
namespace {

TEST(WebOrigin, OwnPagesMayConnect) {
  const WebOrigins own{.any_name = true};
  EXPECT_TRUE(is_allowed(own, "", "example.org"));
  EXPECT_TRUE(is_allowed(own, "http://example.org:8080", "example.org:8080"));
  EXPECT_TRUE(is_allowed(own, "https://example.org", "EXAMPLE.org"));
  EXPECT_FALSE(is_allowed(own, "http://example.org:8080", "example.org:8081"));
  EXPECT_FALSE(is_allowed(own, "http://example.org", "example.org.evil.example"));
  EXPECT_FALSE(is_allowed(own, "http://evil.example", "example.org"));
  EXPECT_FALSE(is_allowed(own, "null", "null"));
  EXPECT_FALSE(is_allowed(own, "ftp://example.org", "example.org"));
  EXPECT_FALSE(is_allowed(own, "http://", ""));
}

TEST(WebOrigin, OthersWhereTheyAreNamed) {
  const WebOrigins some{.others = {"https://a.example", "http://b.example:99"}};
  EXPECT_TRUE(is_allowed(some, "https://A.example", "here"));
  EXPECT_TRUE(is_allowed(some, "http://b.example:99", "here"));
  EXPECT_FALSE(is_allowed(some, "http://a.example", "here"));
  EXPECT_FALSE(is_allowed(some, "*", "here"));
  EXPECT_TRUE(is_allowed({.others = {"*"}}, "https://any.example", "here"));
}

TEST(WebOrigin, NamesOfOthersAreNotOursUnlessCallersAreKnown) {
  for (const char* host : {"localhost:8080", "127.0.0.1", "127.0.1.1:80", "[::1]:8080", "[::1]", "LOCALHOST", "192.168.1.7:8080",
                           "workstation:8080", "workstation.local"}) {
    EXPECT_TRUE(is_allowed({}, std::string("http://") + host, host)) << host;
  }
  for (const char* host :
       {"rebound.example", "localhost.evil.example:8080", "127.0.0.1.evil.example", "evil.example.", "local.evil.example:80"}) {
    EXPECT_FALSE(is_allowed({}, std::string("http://") + host, host)) << host;
    EXPECT_TRUE(is_allowed({.any_name = true}, std::string("http://") + host, host)) << host;
  }
}

TEST(WebOrigin, APageMayAskWhereItIsOurOwnOrAllowed) {
  const WebOrigins origins{.others = {"https://viewer.example"}};
  const auto may = [&](const WebPage& page) { return check_page(origins, page).ok(); };
  EXPECT_TRUE(may({.host = "localhost:8080"})) << "a program";
  EXPECT_TRUE(may({.host = "192.168.0.7", .fetch_site = "same-origin"}));
  EXPECT_TRUE(may({.origin = "https://viewer.example", .host = "localhost", .fetch_site = "cross-site"}));
  EXPECT_TRUE(may({.host = "viewer.example"})) << "a name that is known to be ours";
  EXPECT_FALSE(may({.origin = "https://evil.example", .host = "localhost"}));
  EXPECT_FALSE(may({.host = "localhost", .fetch_site = "cross-site"}));
  EXPECT_FALSE(may({.host = "localhost", .fetch_site = "same-site"}));
  EXPECT_FALSE(may({.host = "evil.example"})) << "that its owner let point here";
  EXPECT_FALSE(may({.host = ""}));
  EXPECT_TRUE(check_page({.any_name = true}, {.host = "curvecast.example"}).ok());
}

}  // namespace
}  // namespace curvecast::server
