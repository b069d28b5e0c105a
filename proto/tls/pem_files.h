// SPDX-License-Identifier: Apache-2.0
// Certificates and keys from files, looked at before gRPC does, which would only say later that something does not work.
#pragma once

#include <absl/status/statusor.h>

#include <string>

namespace curvecast::tls {

/// Who one side is, as PEM.
struct Identity {
  std::string certificates;  // its own, then those that vouch for it
  std::string key;
};

/// Errors name the file: NotFound or InvalidArgument where one cannot be read, InvalidArgument where there is no certificate or
/// no key in it, a certificate is malformed, the key is encrypted, or it does not belong to the first certificate.
absl::StatusOr<Identity> read_identity(const std::string& certificate_path, const std::string& key_path);

/// The certificates of those who are believed. Errors as above.
absl::StatusOr<std::string> read_authorities(const std::string& path);

}  // namespace curvecast::tls
