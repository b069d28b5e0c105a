#include "proto/tls/pem_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/proto/tls/certificate_files.h"

namespace curvecast::tls {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class PemFiles : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { files_ = std::make_unique<testing::CertificateFiles>(); }
  static void TearDownTestSuite() { files_.reset(); }

  static void expect_refused(const absl::Status& status, absl::StatusCode code, const std::string& path,
                             const std::string& message) {
    EXPECT_EQ(status.code(), code) << status;
    EXPECT_THAT(status.message(), AllOf(HasSubstr(path), HasSubstr(message)));
  }

  static inline std::unique_ptr<testing::CertificateFiles> files_;
};

TEST_F(PemFiles, ReadsWhatBelongsTogether) {
  const auto identity = read_identity(files_->cert("ca-server"), files_->key("ca-server"));
  ASSERT_TRUE(identity.ok()) << identity.status();
  EXPECT_EQ(identity->certificates, testing::bytes_of(files_->cert("ca-server")));
  EXPECT_EQ(identity->key, testing::bytes_of(files_->key("ca-server")));
  const auto authorities = read_authorities(files_->cert("ca"));
  ASSERT_TRUE(authorities.ok()) << authorities.status();
  EXPECT_EQ(*authorities, testing::bytes_of(files_->cert("ca")));
}

TEST_F(PemFiles, SaysWhatIsWrongWithWhichFile) {
  const std::string cert = files_->cert("ca-server"), key = files_->key("ca-server");
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  constexpr auto kMissing = absl::StatusCode::kNotFound;
  expect_refused(read_identity("/nonexistent.pem", key).status(), kMissing, "/nonexistent.pem", "cannot be opened: No such file");
  expect_refused(read_identity(cert, "/nonexistent.key").status(), kMissing, "/nonexistent.key", "cannot be opened");
  expect_refused(read_authorities("/nonexistent.pem").status(), kMissing, "/nonexistent.pem", "cannot be opened");
  expect_refused(read_authorities("/tmp").status(), kInvalid, "/tmp", "");
  const std::string nonsense = files_->write("nonsense", "nonsense"), empty = files_->write("empty", "");
  for (const std::string& bad : {nonsense, empty}) {
    expect_refused(read_identity(bad, key).status(), kInvalid, bad, "no certificate");
    expect_refused(read_identity(cert, bad).status(), kInvalid, bad, "no private key");
    expect_refused(read_authorities(bad).status(), kInvalid, bad, "no certificate");
  }
  expect_refused(read_identity(key, cert).status(), kInvalid, key, "no certificate");  // swapped
  expect_refused(read_identity(cert, files_->key("ca-client")).status(), kInvalid, files_->key("ca-client"),
                 "does not belong to the certificate in " + cert);
  const std::string encrypted = files_->encrypted_key("ca-server");
  expect_refused(read_identity(cert, encrypted).status(), kInvalid, encrypted, "encrypted");
  const std::string half = files_->write(
      "half", *read_authorities(files_->cert("ca")) + "-----BEGIN CERTIFICATE-----\nbm9uZQ==\n-----END CERTIFICATE-----\n");
  expect_refused(read_authorities(half).status(), kInvalid, half, "malformed");
  expect_refused(read_authorities(files_->write("large", std::string(2 << 20, 'x'))).status(), kInvalid, "large", "too large");
}

}  // namespace
}  // namespace curvecast::tls
