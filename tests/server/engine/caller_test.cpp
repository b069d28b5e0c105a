#include "server/engine/caller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "server/base/log.h"
#include "server/base/options.h"
#include "server/engine/engine.h"

namespace curvecast::server {
namespace {

using ::testing::ElementsAre;

// printf %s secret | sha256sum
constexpr char kTokens[] = "anna 2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b";
constexpr char kAddress[] = "ipv4:198.51.100.1:4711";

/// Of a server that asks for tokens, certificates, or both.
Caller identified(const Peer& peer, bool asks_for_tokens, bool asks_for_certificates) {
  ServerOptions options{.threads = 1};
  if (asks_for_certificates) options.tls_client_ca = "authorities.pem";
  const Engine engine(options, make_logger(false, false), nullptr,
                      asks_for_tokens ? Tokens::parse(kTokens, "tokens").value() : nullptr);
  const absl::StatusOr<Caller> caller = identify(engine, peer);
  EXPECT_TRUE(caller.ok() || absl::IsUnauthenticated(caller.status())) << caller.status();
  return caller.value_or(Caller{.name = "unknown"});
}

/// Name and owner.
std::vector<std::string> names(const Caller& caller) { return {caller.name, caller.owner}; }

TEST(Caller, IsAnAddressWhereNobodyAsks) {
  const Caller caller = identified({.address = kAddress, .authorization = "Bearer secret"}, false, false);
  EXPECT_THAT(names(caller), ElementsAre("ipv4:198.51.100.1", ""));
  EXPECT_EQ(caller.address, kAddress);
}

TEST(Caller, IsWhoseTheTokenIs) {
  for (const bool asks_for_certificates : {false, true}) {
    EXPECT_THAT(names(identified({.address = kAddress, .authorization = "Bearer secret", .certificate = "bert"}, true,
                                 asks_for_certificates)),
                ElementsAre("anna", "anna"));
    EXPECT_EQ(identified({.address = kAddress, .certificate = "bert"}, true, asks_for_certificates).name, "unknown");
  }
}

TEST(Caller, IsWhoseTheCertificateIs) {
  EXPECT_THAT(names(identified({.address = kAddress, .certificate = "bert"}, false, true)), ElementsAre("bert", "bert"));
  EXPECT_THAT(names(identified({.address = kAddress}, false, true)), ElementsAre("ipv4:198.51.100.1", ""));
}

// A proxy's certificate is not that of its clients, whose limits are not the proxy's.
TEST(Caller, OfAProxyIsAnAddressThatTheProxyVouchesFor) {
  EXPECT_THAT(names(identified({.address = kAddress, .comes_by_proxy = true, .certificate = "proxy"}, false, true)),
              ElementsAre("ipv4:198.51.100.1", "proxy"));
}

TEST(Caller, MayBeThisProcess) {
  const Peer own = {.address = "this process"};
  EXPECT_THAT(names(identified(own, false, false)), ElementsAre("this process", ""));
  EXPECT_THAT(names(identified(own, true, false)), ElementsAre("this process", "this process"));
  EXPECT_THAT(names(identified(own, false, true)), ElementsAre("this process", "this process"));
}

}  // namespace
}  // namespace curvecast::server
