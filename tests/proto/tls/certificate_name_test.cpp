#include "proto/tls/certificate_name.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/proto/tls/certificate_files.h"

namespace curvecast::tls {
namespace {

TEST(CertificateName, IsTheMostTellingOneThereIs) {
  const testing::CertificateFiles files;
  const auto name_of = [&](const std::string& subject, const std::string& alternatives) {
    files.issue("ca", "named", subject, alternatives);
    return certificate_name(testing::bytes_of(files.cert("named")));
  };
  EXPECT_EQ(name_of("/CN=common", "IP:127.0.0.1,email:anna@example.org,DNS:a.example.org,URI:spiffe://example.org/anna"),
            "spiffe://example.org/anna");
  EXPECT_EQ(name_of("/CN=common", "email:anna@example.org,DNS:a.example.org,DNS:b.example.org"), "a.example.org");
  EXPECT_EQ(name_of("/CN=common", "IP:127.0.0.1,email:anna@example.org"), "anna@example.org");
  EXPECT_EQ(name_of("/O=Example/CN=common", "IP:127.0.0.1"), "common");
  EXPECT_EQ(name_of("/O=Example/CN=common", ""), "common");
  EXPECT_EQ(name_of("/C=CH/O=Example", ""), "O=Example,C=CH");
  EXPECT_EQ(name_of("/", ""), "");
}

TEST(CertificateName, NeedsACertificate) {
  EXPECT_EQ(certificate_name(std::string()), "");
  EXPECT_EQ(certificate_name(std::string("-----BEGIN CERTIFICATE-----\nbm9uZQ==\n-----END CERTIFICATE-----\n")), "");
}

}  // namespace
}  // namespace curvecast::tls
