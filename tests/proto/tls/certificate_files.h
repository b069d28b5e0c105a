// Certificates and keys for tests, made by the openssl command.
#pragma once

#include <string>

#include "tests/support/temporary_folder.h"

namespace curvecast::testing {

/// All of them in a folder of its own.
class CertificateFiles {
 public:
  /// Two authorities, "ca" and "other", that know nothing of each other; each has vouched for a server on the loopback and a
  /// client.
  CertificateFiles();

  /// For example "ca", "ca-server", "ca-client", "other-client".
  std::string cert(const std::string& name) const { return folder_ / (name + ".pem"); }
  std::string key(const std::string& name) const { return folder_ / (name + ".key"); }
  /// A file of the caller's in the same folder.
  std::string write(const std::string& name, const std::string& text) const;
  /// Has one of the authorities vouch for a certificate "NAME", with a subject such as "/CN=anna" and alternative names such as
  /// "DNS:anna.example.org,URI:spiffe://example.org/anna"; empty: none.
  void issue(const std::string& authority, const std::string& name, const std::string& subject,
             const std::string& alternatives) const;
  /// The key of `name`, protected by a password.
  std::string encrypted_key(const std::string& name) const;

 private:
  TemporaryFolder folder_;
};

}  // namespace curvecast::testing
